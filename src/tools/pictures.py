# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a recorded bag in rviz, on a virtual screen with software rendering."""

import os
import subprocess
import time

import rosgraph
import yaml

from ros_master import master_port, use_new_master

SCREEN = "1280x900x24"
CONFIG = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "config",
                      "polyscalpel.rviz")


class PictureError(Exception):
    """A picture could not be made."""


def run(command, what, timeout_s, **options):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, check=False, **options)
    except subprocess.TimeoutExpired:
        raise PictureError(f"{what} took more than {timeout_s} s") from None
    if done.returncode != 0:
        raise PictureError(f"{what}: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout


def wait_until(condition, what, children, timeout_s=60):
    deadline = time.monotonic() + timeout_s
    while not condition():
        ended = children.ended()
        if ended:
            raise PictureError(f"{ended[0]} ended with status {ended[1]}, see {children.log_path(ended[0])}")
        if time.monotonic() > deadline:
            raise PictureError(f"{what} took more than {timeout_s} s")
        time.sleep(0.1)


def play(children, command, timeout_s=600):
    """Runs rosbag play, which waits for ever where the master goes with an rviz that dies."""
    player = children.start("rosbag_play", command)
    deadline = time.monotonic() + timeout_s
    while player.poll() is None:
        ended = children.ended()
        if ended and player.poll() is None:
            raise PictureError(f"{ended[0]} ended with status {ended[1]}, see {children.log_path(ended[0])}")
        if time.monotonic() > deadline:
            raise PictureError(f"rosbag play took more than {timeout_s} s")
        time.sleep(0.1)
    if player.returncode != 0:
        raise PictureError(f"rosbag play ended with status {player.returncode}, see {children.log_path('rosbag_play')}")
    children.stop(player)


def start_screen(children):
    """A virtual screen; returns its name for DISPLAY. The server itself picks a number that is free."""
    reading, writing = os.pipe()
    children.start("xvfb", ["Xvfb", "-displayfd", str(writing), "-screen", "0", SCREEN, "+extension", "GLX", "-nolisten",
                            "tcp", "-noreset"], pass_fds=[writing])
    os.close(writing)
    with os.fdopen(reading) as pipe:  # ends when the server does
        number = pipe.readline().strip()
    if not number:
        raise PictureError(f"Xvfb did not start, see {children.log_path('xvfb')}")
    return f":{number}"


def has_master():
    try:
        rosgraph.Master("/demo").getPid()
        return True
    except (OSError, rosgraph.MasterException):
        return False


def shows_mesh():
    try:
        subscribers = rosgraph.Master("/demo").getSystemState()[1]
    except (OSError, rosgraph.MasterException):
        return False
    return any(topic == "/mesh" for topic, _ in subscribers)


def is_picture(path):
    """Whether a picture shows more than a window without content: rviz draws thousands of colours."""
    return int(run(["identify", "-format", "%k", path], "identify", 30)) > 500


def take(path, environment):
    """Takes the screen once rviz has drawn what it got last."""
    time.sleep(2)
    for _ in range(10):
        run(["import", "-window", "root", path], "import", 30, env=environment)
        if is_picture(path):
            return
        time.sleep(1)
    raise PictureError(f"rviz shows nothing: {path}")


def write_view(path, view, has_table):
    """The package's view of a bag, from another place or without the table."""
    with open(CONFIG, encoding="utf-8") as file:
        config = yaml.safe_load(file)
    manager = config["Visualization Manager"]
    manager["Views"]["Current"].update(view)
    if not has_table:
        manager["Displays"] = [display for display in manager["Displays"] if display["Class"] != "rviz/Grid"]
    with open(path, "w", encoding="utf-8") as file:
        yaml.safe_dump(config, file)


def make_pictures(children, bag, pictures, view=None, has_table=True):
    """pictures: (seconds after the bag's start, or None for its end; path of the picture), by time. view: what of rviz's
    current view is to be otherwise than in the package's."""
    use_new_master()
    config = os.path.join(os.path.dirname(os.path.abspath(children.log_path("view"))), "view.rviz")
    write_view(config, view or {}, has_table)
    launch_command = ["roslaunch", "-p", master_port(), "polyscalpel", "playback.launch", "rviz_args:=--fullscreen",
                      f"rviz_config:={config}"]
    display = start_screen(children)
    environment = dict(os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1", QT_X11_NO_MITSHM="1",
                       XDG_RUNTIME_DIR=os.path.dirname(children.log_path("x")))
    environment.pop("WAYLAND_DISPLAY", None)
    environment["QT_QPA_PLATFORM"] = "xcb"
    children.start("rviz", launch_command, env=environment)
    wait_until(has_master, "the start of the master", children)
    wait_until(shows_mesh, "the start of rviz", children)
    time.sleep(3)
    start_s = 0.0
    for end_s, path in pictures:
        command = ["rosbag", "play", "--quiet", "--clock", "--hz=100", "--rate=2", "--delay=1", f"--start={start_s}"]
        if end_s is not None:
            command.append(f"--duration={end_s - start_s}")
        play(children, command + [bag])
        take(path, environment)
        start_s = end_s
