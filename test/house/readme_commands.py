#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every rosservice line of README.md works when pasted, in the order of the page."""

import os
import re
import shlex
import subprocess
import sys
import unittest

import rospy
import rostest
from polyscalpel.msg import StepStatus

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class ReadmeCommands(unittest.TestCase):
    def test_each_service_line_succeeds(self):
        rospy.wait_for_message("/status", StepStatus, timeout=60)
        with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
            lines = re.findall(r"^ {4}(rosservice call .*)$", file.read(), re.MULTILINE)
        services = {shlex.split(line)[2] for line in lines}
        self.assertEqual(services, {"/cut", "/set_paused", "/step", "/reset"})
        for line in lines:
            done = subprocess.run(shlex.split(line), capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")
            self.assertRegex(done.stdout, r"(?m)^success: True$", f"{line}\n{done.stdout}{done.stderr}")
        status = rospy.wait_for_message("/status", StepStatus, timeout=60)
        self.assertEqual((status.pieces, status.cuts), (1, 0), "the last line resets")


if __name__ == "__main__":
    rospy.init_node("readme_commands")
    rostest.rosrun("polyscalpel", "readme_commands", ReadmeCommands, sys.argv)
