#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the nodes refuse at start-up: one clear line and an exit code; and a path that is played as it is written."""
import os
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import PoseStamped

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import PATIENCE_S, wait_until  # noqa: E402

BLOCK = 'mesh: {box: {}}\n'


class StartUpTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('start_up_rostest')

    def run_node(self, node, name, *parameters):
        executable = roslib.packages.find_node('polyscalpel', node)[0]
        done = subprocess.run([executable, '__name:=' + name, *parameters], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, timeout=PATIENCE_S)
        return done.returncode, done.stdout

    def refuse(self, node, parameter, text, *words):
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write(text)
            file.flush()
            code, output = self.run_node(node, 'refused_' + node, parameter + file.name)
        self.assertNotEqual(code, 0, output)
        fatal = [line for line in output.splitlines() if 'FATAL' in line]
        self.assertEqual(len(fatal), 1, output)
        for word in (file.name, *words):
            self.assertIn(word, fatal[0])

    def test_bad_scenes(self):
        for text, words in [
                ('', ['map']),
                ('mesh: [', ['no valid YAML']),
                ('material: {}\n', ['mesh is missing']),
                (BLOCK + 'materal: {}\n', [':2', 'unknown key', 'did you mean material?']),
                (BLOCK + 'integration: {time_step_s: 2}\n', [':2', 'integration.time_step_s = 2', '[1e-06, 1]']),
                (BLOCK + 'integration: {time_step_s: .nan}\n', [':2', '.nan', '[1e-06, 1]']),
                (BLOCK + 'integration: {time_step_s: soon}\n', [':2', 'soon', 'number']),
                (BLOCK + 'node: {clock: slow}\n', ['realtime, lockstep']),
                (BLOCK + 'tools: [{name: a}, {name: a}]\n', ['a']),
                ('mesh: {file: {path: no_such_mesh.msh}}\n', [':1', 'mesh.file.path', 'no_such_mesh.msh', 'tried']),
                ('mesh: {file: {path: /dev/null}}\n', ['mesh.file.path', '/dev/null']),
        ]:
            with self.subTest(text=text):
                self.refuse('polyscalpel_node', '_scene:=', text, *words)

    def test_bad_mesh_files(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (('empty.msh', ''), ('words.msh', 'no mesh at all\n'), ('model.xyz', '1 2 3\n')):
                with open(os.path.join(folder, name), 'w') as file:
                    file.write(content)
                scene = os.path.join(folder, 'scene.yaml')
                with open(scene, 'w') as file:
                    file.write('mesh: {file: {path: %s}}\n' % name)
                code, output = self.run_node('polyscalpel_node', 'bad_mesh', '_scene:=' + scene)
                self.assertNotEqual(code, 0, output)
                fatal = [line for line in output.splitlines() if 'FATAL' in line]
                self.assertEqual(len(fatal), 1, output)
                self.assertIn(name, fatal[0])

    def test_parameters(self):
        code, output = self.run_node('polyscalpel_node', 'nothing_given')
        self.assertNotEqual(code, 0)
        self.assertIn('/nothing_given/scene is missing', output)
        code, output = self.run_node('polyscalpel_node', 'mistyped', '_scne:=block.yaml')
        self.assertNotEqual(code, 0)
        self.assertIn('did you mean ~scene?', output)
        code, output = self.run_node('polyscalpel_node', 'no_file', '_scene:=/no/such/scene.yaml')
        self.assertNotEqual(code, 0)
        self.assertIn('/no/such/scene.yaml', output)

    def test_bad_paths(self):
        self.refuse('simulated_tool', '_path:=', 'key_frames: []\n', 'key_frames', 'at least 2')
        self.refuse('simulated_tool', '_path:=', 'key_frames:\n- {time_s: -1, position_m: [0, 0, 0]}\n'
                    '- {time_s: 1, position_m: [0, 0, 0]}\n', ':2', 'key_frames[0].time_s', '-1')
        code, output = self.run_node('simulated_tool', 'bad_rate', '_path:=x', '_rate:=0')
        self.assertNotEqual(code, 0)
        self.assertIn('[0.1, 10000]', output)

    def test_a_path_is_played_as_it_is_written(self):
        poses = []
        subscriber = rospy.Subscriber('probe/measured_cp', PoseStamped, poses.append, queue_size=None)
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write('tool: probe\nframe: table\nkey_frames:\n- {time_s: 0, position_m: [0, 0, 0]}\n'
                       '- {time_s: 0.5, position_m: [1, 0, 0]}\n')
            file.flush()
            code, output = self.run_node('simulated_tool', 'probe_player', '_path:=' + file.name, '_rate:=50')
        self.assertEqual(code, 0, output)
        wait_until(lambda: len(poses) == 26, '26 poses')
        start = poses[0].header.stamp
        for i, message in enumerate(poses):
            self.assertEqual(message.header.frame_id, 'table')
            self.assertAlmostEqual((message.header.stamp - start).to_sec(), 0.02 * i, 8)
            self.assertAlmostEqual(message.pose.position.x, 0.04 * i, 12)
        subscriber.unregister()


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'start_up', StartUpTest)
