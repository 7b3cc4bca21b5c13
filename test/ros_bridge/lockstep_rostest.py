#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Poses in, markers, wrenches and cuts out, in lockstep; and poses that no one should send."""
import os
import sys
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import Hand, Listener, Services, digest, pose, shapes, stroke, wait_until  # noqa: E402

H = 0.01
T0 = 100.0
NAN = float('nan')


class LockstepTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('lockstep_rostest')
        cls.services = Services()
        cls.listener = Listener(['scalpel', 'finger'])
        cls.hand = Hand(['scalpel', 'finger'])
        cls.start = shapes(cls.listener.mesh[0])

    def setUp(self):
        self.services.set_paused(False)
        self.start_anew()

    def start_anew(self):
        """The state at the start, and nothing in the lists."""
        self.assertTrue(self.services.reset().success)
        wait_until(lambda: self.listener.mesh and self.listener.mesh[-1].markers[0].header.stamp == rospy.Time() and
                   self.listener.status and self.listener.status[-1].step == 0, 'the reset')
        self.settle()
        self.listener.clear()

    def settle(self):
        """Until nothing that was sent is under way any more."""
        time.sleep(0.3)

    def send(self, tool, messages):
        for message in messages:
            self.hand.send(tool, message)

    def wait_for_time(self, time_s):
        wait_until(lambda: self.listener.status and self.listener.status[-1].time_s > time_s - H / 2, 't = %g s' % time_s)
        wait_until(lambda: self.listener.contacts and self.listener.contacts[-1].time_s > time_s - H / 2, 'contacts')
        wait_until(lambda: self.listener.mesh and self.listener.mesh[-1].markers[0].header.stamp.to_sec() - T0 >
                   time_s - 1.5 * H, 'the mesh')
        self.settle()

    def away(self, duration_s, start_s=T0):
        """Poses of a tool that is there and touches nothing."""
        return stroke(start_s, (0.2, 0, 0), (0.2, 0, 0), duration_s)

    def slice(self, start_s=T0):
        return stroke(start_s, (0.016, -0.02, 0), (0.017, 0.05, 0))

    def run_slice(self):
        self.send('finger', self.away(1.0))
        self.send('scalpel', self.slice())
        self.wait_for_time(1.0)

    def test_a_slice_makes_two_pieces(self):
        self.run_slice()
        status = self.listener.status[-1]
        self.assertEqual((status.step, status.pieces, status.clock), (100, 2, 'lockstep'))
        self.assertEqual([s.step for s in self.listener.status[-100:]], list(range(1, 101)))
        self.assertTrue(all(s.converged for s in self.listener.status))
        self.assertIn(status.solver, ('direct', 'jacobi', 'factor', 'aggregates'))
        self.assertEqual((status.budget_ended, status.budget_left_out, status.half_steps), (False, False, 0))
        self.assertLess(status.volume_relative_error, 1e-9)
        self.assertTrue(self.listener.cuts)
        for event in self.listener.cuts:
            self.assertEqual((event.source, event.header.frame_id), ('scalpel', 'world'))
            self.assertAlmostEqual(event.header.stamp.to_sec(), T0 + event.time_s, 6)
        self.assertEqual(self.listener.cuts[-1].pieces_after, 2)
        # Each split gives one cell more and one cap, of one facet or of several where it is bent, seen from both sides.
        new_faces = sum(event.new_faces for event in self.listener.cuts)
        self.assertGreaterEqual(new_faces, 2 * (status.cells - 27))
        self.assertEqual(new_faces % 2, 0)
        self.assertEqual(sum(event.cells_split for event in self.listener.cuts), status.cells - 27)

    def test_what_is_pending_is_shown_and_goes_with_the_blade(self):
        self.run_slice()
        counts = {s.header.stamp: next(t.pending_crossings for t in s.tools if t.name == 'scalpel')
                  for s in self.listener.status if s.step > 0}
        meshes = [m for m in self.listener.mesh if m.markers[0].header.stamp > rospy.Time(100)]
        self.assertEqual(len(meshes), 50)
        shown = []
        for message in meshes:
            pending = [m for m in message.markers if m.ns == 'pending']
            points = sum(len(m.points) for m in pending if m.action == Marker.ADD)
            self.assertEqual(points, counts[message.markers[0].header.stamp])
            was_shown = bool(shown) and shown[-1] > 0
            self.assertEqual([m.action for m in pending],
                             [Marker.ADD] if points else [Marker.DELETE] if was_shown else [])
            shown.append(points)
        self.assertGreater(max(shown), 0)
        self.assertEqual((shown[0], shown[-1]), (0, 0), 'before the blade meets the tissue, and when it has left it')

    def test_frames_and_stamps(self):
        self.run_slice()
        for tool in ('scalpel', 'finger'):
            wrenches = self.listener.wrenches[tool]
            self.assertEqual(len(wrenches), 100)
            for i, wrench in enumerate(wrenches):
                self.assertEqual(wrench.header.frame_id, tool)
                self.assertEqual(wrench.header.stamp, rospy.Time(int(T0), (i + 1) * 10000000) if i < 99 else rospy.Time(101))
        meshes = [m for m in self.listener.mesh if m.markers[0].header.stamp > rospy.Time(100)]
        self.assertEqual(len(meshes), 50, 'every second step')
        for message in meshes:
            self.assertEqual({m.header.frame_id for m in message.markers}, {'world'})
            self.assertEqual(len({m.header.stamp for m in message.markers}), 1)
            for marker in message.markers:
                if marker.type == Marker.TRIANGLE_LIST and marker.action == Marker.ADD:
                    self.assertEqual(len(marker.points) % 3, 0)
                    self.assertEqual(len(marker.colors), len(marker.points))
        self.assertEqual(len(self.listener.contacts), 100)

    def test_a_finger_feels_what_it_presses(self):
        self.send('scalpel', self.away(1.0))
        self.send('finger', stroke(T0, (0.015, 0.015, 0.045), (0.015, 0.015, 0.034)))
        self.wait_for_time(1.0)
        wrench = self.listener.wrenches['finger'][-1].wrench
        self.assertGreater(wrench.force.z, 0.01, 'the tissue pushes back')
        contacts = self.listener.contacts[-1]
        self.assertEqual(contacts.header.frame_id, 'world')
        self.assertTrue(contacts.contacts)
        for axis in 'xyz':  # the finger is not turned: its frame's axes are the world's
            total = sum(getattr(contact.force, axis) for contact in contacts.contacts)
            self.assertAlmostEqual(getattr(wrench.force, axis), -total, 9)
        self.assertTrue(all(contact.tool == 'finger' for contact in contacts.contacts))
        self.assertTrue(all(w.wrench.force.z == 0 for w in self.listener.wrenches['scalpel']))
        self.assertEqual(self.listener.status[-1].contacts, len(contacts.contacts))
        self.assertTrue([m for m in self.listener.mesh[-1].markers if m.ns == 'contacts' and m.action == Marker.ADD])

    def test_the_same_poses_give_the_same_bits(self):
        runs = []
        for _ in range(2):
            self.start_anew()
            self.run_slice()
            runs.append((digest(self.listener.mesh), digest(self.listener.contacts), digest(self.listener.cuts)))
        self.assertEqual(runs[0], runs[1])
        self.services.reset()
        wait_until(lambda: shapes(self.listener.mesh[-1]) == self.start, 'the start')

    def test_bad_poses_are_counted_and_harmless(self):
        self.run_slice()
        clean = digest(self.listener.mesh)
        self.start_anew()
        self.send('finger', self.away(1.0))
        for i, message in enumerate(self.slice()):
            self.hand.send('scalpel', message)
            stamp_s = message.header.stamp.to_sec()
            if i == 10:
                self.hand.send('scalpel', pose(stamp_s + 0.001, (NAN, 0, 0)))
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), (0, 0, float('inf'), 1)))
            if i == 20:
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), (0, 0, 0, 0)))
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), (0, 0, 0, 1.1)))
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), (0.5, 0.5, 0.5, 0.6)))
            if i == 30:
                self.hand.send('scalpel', pose(stamp_s - 0.2, (0, 0, 0)))
                self.hand.send('scalpel', pose(0, (0, 0, 0)))
            if i == 40:
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), frame=''))
                self.hand.send('scalpel', pose(stamp_s + 0.001, (0, 0, 0), frame='scalpel'))
        self.wait_for_time(1.0)
        tool = self.listener.tool('scalpel')
        self.assertEqual((tool.poses_not_finite, tool.poses_bad_quaternion, tool.poses_bad_stamp, tool.poses_no_transform),
                         (2, 3, 2, 2))
        self.assertEqual((tool.poses_received, tool.jumps, tool.clock_jumps), (60, 0, 0))
        self.assertEqual(digest(self.listener.mesh), clean)
        wait_until(lambda: any('poses_not_finite' in [v.key for v in entry.values] and entry.name.endswith('scalpel')
                               for array in self.listener.diagnostics for entry in array.status), 'diagnostics')

    def test_poses_of_an_unknown_frame_are_dropped(self):
        self.send('finger', self.away(1.0))
        self.send('scalpel', self.away(0.4))
        self.send('scalpel', [pose(T0 + 0.41 + 0.01 * i, (0.016, 0.015, 0), frame='nowhere') for i in range(10)])
        self.send('scalpel', self.away(0.4, T0 + 0.6))
        self.wait_for_time(1.0)
        self.assertEqual(self.listener.tool('scalpel').poses_no_transform, 10)
        self.assertEqual(self.listener.status[-1].pieces, 1)

    def test_poses_in_another_frame(self):
        transform = TransformStamped()
        transform.header.frame_id = 'world'
        transform.child_frame_id = 'camera'
        transform.transform.translation.x = 1
        transform.transform.rotation.z = 1  # half a turn about z: a pose at (1, 0, 0) is the world's origin
        there = [pose(m.header.stamp.to_sec(), (1 - m.pose.position.x, -m.pose.position.y, m.pose.position.z),
                      (0, 0, 1, 0), 'camera') for m in self.slice()]
        # Some poses come first and wait for their transform, for less than tf_timeout_s of stamps.
        self.send('finger', self.away(1.0)[:8])
        self.send('scalpel', there[:8])
        self.settle()
        self.assertFalse(self.listener.wrenches['scalpel'])
        publisher = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        publisher.publish(TFMessage([transform]))
        wait_until(lambda: self.listener.wrenches['scalpel'], 'steps')
        self.send('finger', self.away(1.0)[8:])
        self.send('scalpel', there[8:])
        self.wait_for_time(1.0)
        self.assertEqual(self.listener.tool('scalpel').poses_no_transform, 0)
        self.assertEqual(self.listener.status[-1].pieces, 2)

    def test_a_jump_does_not_slash(self):
        self.send('finger', self.away(1.0))
        self.send('scalpel', stroke(T0, (0.016, -0.5, 0), (0.016, -0.5, 0), 0.5))
        self.send('scalpel', stroke(T0 + 0.51, (0.016, 0.5, 0), (0.016, 0.5, 0), 0.5))
        self.wait_for_time(1.0)
        self.assertEqual(self.listener.tool('scalpel').jumps, 1)
        self.assertEqual((self.listener.status[-1].pieces, self.listener.status[-1].cuts), (1, 0))

    def test_a_publisher_that_dies_in_the_tissue(self):
        half = [m for m in self.slice() if m.pose.position.y < 0.016]
        last_s = half[-1].header.stamp.to_sec() - T0
        self.send('scalpel', half)
        self.send('finger', self.away(5.0))
        self.wait_for_time(5.0)  # the finger's stamps carry time on once the scalpel is let go
        self.assertEqual(self.listener.tool('scalpel').timeouts, 1)
        self.assertFalse(self.listener.tool('scalpel').enabled)
        self.assertEqual(self.listener.status[-1].pieces, 1)
        self.assertTrue(all(s.converged for s in self.listener.status))
        self.assertTrue(self.listener.status[int(last_s / H) - 2].tools[0].enabled)
        # It comes back elsewhere: set down anew, no slash on the way.
        cuts = self.listener.status[-1].cuts
        # First, since the finger's stamps alone carry time on as long as the scalpel has no pose.
        self.send('scalpel', self.away(1.0, T0 + 5.02))
        self.send('finger', self.away(1.0, T0 + 5.02))
        self.wait_for_time(6.0)
        self.assertTrue(self.listener.tool('scalpel').enabled)
        self.assertEqual(self.listener.status[-1].pieces, 1)
        self.assertLessEqual(self.listener.status[-1].cuts, cuts + 1, 'the stroke may end, nothing more')

    def test_a_looping_clock_begins_anew(self):
        for _ in range(2):
            self.send('finger', self.away(2.0))
            self.send('scalpel', self.slice() + self.away(0.9, T0 + 1.1))
        wait_until(lambda: self.listener.status[-1].step >= 398, 'two loops')
        self.settle()
        self.assertEqual(self.listener.tool('finger').clock_jumps, 1)
        self.assertEqual(self.listener.tool('scalpel').poses_bad_stamp, 0)
        times = [status.time_s for status in self.listener.status if status.step > 0]
        self.assertEqual(times, sorted(times))
        self.assertTrue(all(s.converged for s in self.listener.status))
        self.assertGreaterEqual(self.listener.status[-1].pieces, 2)

    def test_services_while_paused(self):
        self.services.set_paused(True)
        self.send('finger', self.away(1.0))
        self.send('scalpel', self.away(1.0))
        self.settle()
        self.assertEqual(self.services.step(10).step, 10)
        response = self.services.step(1000)
        self.assertFalse(response.success)
        self.assertIn('90 of 1000 steps made', response.message)
        self.settle()
        self.assertEqual(self.listener.status[-1].step, 100)
        self.services.set_paused(False)


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'lockstep', LockstepTest)
