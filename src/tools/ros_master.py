# SPDX-License-Identifier: BSD-3-Clause
"""A ROS master of one's own, so that nothing else on the machine is disturbed or disturbs."""

import os
import socket


def _free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def use_new_master():
    """Sends this program and all it starts to a master on a port of its own; roslaunch is to start it there."""
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{_free_port()}"


def master_port():
    return os.environ["ROS_MASTER_URI"].rpartition(":")[2]


def use_own_folders(logs):
    """Keeps what ROS writes in a folder, made unless it is there."""
    os.makedirs(logs, mode=0o700, exist_ok=True)
    os.environ.update(ROS_HOSTNAME="localhost", ROS_HOME=logs, ROS_LOG_DIR=logs, PYTHONUNBUFFERED="1")
