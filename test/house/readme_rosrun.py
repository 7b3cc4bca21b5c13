#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every rosrun line of README.md works when pasted: the simulation starts and takes the poses of the simulated tool."""

import os
import re
import signal
import subprocess
import sys
import time
import unittest

import rospy
import rostest
from polyscalpel.msg import StepStatus

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PATIENCE_S = 120


def rosrun_lines(node):
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
        return re.findall(rf"^ {{4}}(rosrun polyscalpel {node} .*)$", file.read(), re.MULTILINE)


def start(line):
    # rosrun asks on its input which one is meant where it finds several nodes of a name: there is no one to answer.
    return subprocess.Popen(["bash", "-c", line], cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, start_new_session=True)


class ReadmeRosrun(unittest.TestCase):
    def setUp(self):
        self.newest = None
        self.subscriber = rospy.Subscriber("/status", StepStatus, self.take)

    def take(self, status):
        self.newest = status

    def wait_for_step(self, simulation):
        deadline = time.monotonic() + PATIENCE_S
        while self.newest is None or self.newest.step == 0:
            if simulation.poll() is not None:
                self.fail("has ended:\n" + simulation.communicate()[0])
            self.assertLess(time.monotonic(), deadline, "no step is made")
            time.sleep(0.05)

    def test_the_simulation_takes_the_poses_of_the_tool(self):
        simulations, tools = rosrun_lines("polyscalpel_node"), rosrun_lines("simulated_tool")
        self.assertEqual((len(simulations), len(tools)), (1, 1))
        simulation = start(simulations[0])
        try:
            self.wait_for_step(simulation)
            tool = start(tools[0])
            output, _ = tool.communicate(timeout=PATIENCE_S)
            self.assertEqual(tool.returncode, 0, f"{tools[0]}\n{output}")
            self.assertEqual([tool.name for tool in self.newest.tools], ["scalpel"])
            self.assertGreater(self.newest.tools[0].poses_received, 0)
        finally:
            if simulation.poll() is None:
                os.killpg(simulation.pid, signal.SIGINT)
            output, _ = simulation.communicate(timeout=PATIENCE_S)
        self.assertEqual(simulation.returncode, 0, f"{simulations[0]}\n{output}")


if __name__ == "__main__":
    rospy.init_node("readme_rosrun")
    rostest.rosrun("polyscalpel", "readme_rosrun", ReadmeRosrun, sys.argv)
