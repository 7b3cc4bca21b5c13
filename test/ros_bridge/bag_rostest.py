#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A bag of poses run twice gives the same markers; a bag of markers shows the same without a node."""
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosbag
import rospy
import rostest
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import Listener, Services, digest, stroke, wait_until  # noqa: E402


class BagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('bag_rostest')
        cls.folder = tempfile.TemporaryDirectory()
        cls.poses = os.path.join(cls.folder.name, 'poses.bag')
        with rosbag.Bag(cls.poses, 'w') as bag:
            slices = stroke(100.0, (0.016, -0.02, 0), (0.017, 0.05, 0))
            presses = stroke(100.0, (0.015, 0.015, 0.045), (0.015, 0.015, 0.034))
            for scalpel, finger in zip(slices, presses):
                bag.write('scalpel/measured_cp', scalpel, scalpel.header.stamp)
                bag.write('finger/measured_cp', finger, finger.header.stamp)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def play(self, bag, *options):
        subprocess.check_call(['rosbag', 'play', '--quiet', '--queue=1000', '--delay=1', *options, bag])

    def test_the_same_bag_gives_the_same_markers(self):
        services = Services()
        listener = Listener(['scalpel', 'finger'])
        runs = []
        for rate in ('0.7', '3'):  # however fast it is played
            self.assertTrue(services.reset().success)
            time.sleep(0.5)
            listener.clear()
            recording = os.path.join(self.folder.name, 'mesh_%s.bag' % rate)
            recorder = subprocess.Popen(['rosbag', 'record', '--quiet', '--buffsize=0', '-O', recording, '/mesh', '/status'])
            wait_until(self.is_recorded, 'the recorder')
            self.play(self.poses, '--rate=' + rate)
            wait_until(lambda: listener.status and listener.status[-1].step == 100, '100 steps')
            wait_until(lambda: len(self.moving(listener.mesh)) == 50, '50 meshes')
            time.sleep(1)
            recorder.send_signal(signal.SIGINT)
            recorder.wait()
            # The recorder gives the file its name when it has written the index; its wrapper may end before.
            wait_until(lambda: os.path.exists(recording), 'the recording')
            with rosbag.Bag(recording) as bag:
                self.assertEqual(len(self.moving([m for _, m, _ in bag.read_messages('/mesh')])), 50)
            runs.append((digest(self.moving(listener.mesh)), digest(listener.contacts), digest(listener.cuts)))
            self.assertEqual(listener.status[-1].pieces, 2)
        self.assertEqual(runs[0], runs[1])

        # Without the node's topic: what was recorded is what was seen.
        shown = []
        subscriber = rospy.Subscriber('/playback/mesh', MarkerArray, shown.append, queue_size=None)
        # Kept alive: the player's last messages are lost when it ends before they are sent.
        player = subprocess.Popen(['rosbag', 'play', '--quiet', '--queue=1000', '--delay=2', '--keep-alive',
                                   '--prefix=playback', recording], stdin=subprocess.DEVNULL)
        wait_until(lambda: len(self.moving(shown)) == 50, 'the playback')
        player.send_signal(signal.SIGINT)
        player.wait()
        self.assertEqual(digest(self.moving(shown)), runs[1][0])
        subscriber.unregister()

    @staticmethod
    def is_recorded():
        _, _, state = rospy.get_master().getSystemState()
        subscribers = dict(state[1])
        return any(name.startswith('/record') for name in subscribers.get('/mesh', []))

    @staticmethod
    def moving(meshes):
        """Those of a step; the one that is latched before the first has stamp zero."""
        return [message for message in meshes if message.markers[0].header.stamp > rospy.Time()]


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'bag', BagTest)
