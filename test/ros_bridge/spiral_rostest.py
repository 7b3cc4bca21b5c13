#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The double spiral through the organ leaves two pieces, and its poses sent again give the same to the bit."""
import os
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from visualization_msgs.msg import Marker

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import HERE, Hand, Listener, Services, digest, wait_until  # noqa: E402

PATH = os.path.join(os.path.dirname(os.path.dirname(HERE)), 'config', 'tools', 'spiral_scalpel.yaml')
H = 0.01
STEPS_PER_MESH = 4


class SpiralTest(unittest.TestCase):
    def wait_for_steps(self, listener, count):
        """A good machine takes half a minute for them all: each hundred has its own patience."""
        for part in list(range(100, count, 100)) + [count]:
            wait_until(lambda: listener.status and listener.status[-1].step >= part, 'step %d' % part)
        # The big meshes take longer to read than to make: a busy machine is many of them behind the status.
        counts = [(listener.mesh, count // STEPS_PER_MESH), (listener.contacts, count), (listener.wrenches['scalpel'], count)]
        for messages, expected in counts:
            wait_until(lambda m=messages, e=expected: len(m) >= e, 'what the steps published')

    def test_two_pieces_come_of_it_and_a_replay_is_the_same(self):
        rospy.init_node('spiral_rostest')
        services = Services()
        listener = Listener(['scalpel'])
        poses = []
        recorder = rospy.Subscriber('scalpel/measured_cp', PoseStamped, poses.append, queue_size=None)
        listener.clear()
        simulated_tool = roslib.packages.find_node('polyscalpel', 'simulated_tool')[0]
        subprocess.check_call([simulated_tool, '_path:=' + PATH, '_wait_for_subscribers:=2'])
        wait_until(lambda: len(poses) > 1, 'poses')
        steps = int((poses[-1].header.stamp - poses[0].header.stamp).to_sec() / H + 1e-6)
        self.wait_for_steps(listener, steps)
        recorder.unregister()

        status = listener.status[-1]
        self.assertEqual((status.step, status.pieces, status.cuts), (steps, 2, 1), 'in one go')
        self.assertTrue(all(s.converged for s in listener.status))
        self.assertEqual(status.cells_left_whole, 0)
        self.assertLess(status.volume_relative_error, 1e-12)
        self.assertEqual(listener.tool('scalpel').pending_crossings, 0, 'the blade has left')
        # What comes off is wound through the right lobe: a good part of the 0.32 l of the organ.
        self.assertGreater(min(piece.volume_m3 for piece in listener.cuts[-1].pieces), 0.09e-3)

        def hues(marker_array):
            surface = next(m for m in marker_array.markers if m.ns == 'surface' and m.action == Marker.ADD)
            return {colour.r > colour.b for colour in surface.colors}

        self.assertEqual(hues(listener.mesh[0]), {True}, 'the whole organ is red')
        self.assertEqual(hues(listener.mesh[-1]), {True, False}, 'the piece that came off is blue')

        def seen():
            return [digest(m) for m in (listener.mesh, listener.contacts, listener.cuts, listener.wrenches['scalpel'])]

        first = seen()
        self.assertTrue(services.reset().success)
        wait_until(lambda: listener.status[-1].step == 0, 'the reset')
        wait_until(lambda: listener.mesh[-1].markers[0].header.stamp == rospy.Time(), 'the mesh of the reset')
        listener.clear()
        hand = Hand(['scalpel'])
        for pose in poses:
            hand.send('scalpel', pose)
        self.wait_for_steps(listener, steps)
        self.assertEqual(seen(), first)


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'spiral', SpiralTest)
