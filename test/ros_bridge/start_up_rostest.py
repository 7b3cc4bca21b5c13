#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the nodes refuse at start-up: one clear line and an exit code; and a path that is played as it is written."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import PoseStamped

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import PATIENCE_S, Listener, wait_until  # noqa: E402

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
                (BLOCK + 'integration: {time_step_s: 0}\n', [':2', 'integration.time_step_s = 0', '[1e-06, 1]']),
                (BLOCK + 'solver: {kind: CHOLMOD}\n', [':2', 'solver.kind = CHOLMOD', 'auto, direct, jacobi, factor, aggregates']),
                (BLOCK + 'solver: {tolerance: 0}\n', [':2', 'solver.tolerance = 0', '[1e-12, 0.1]']),
                (BLOCK + 'solver: {tolerance: .nan}\n', [':2', 'solver.tolerance = .nan', '[1e-12, 0.1]']),
                (BLOCK + 'solver: {step_budget_ms: 0}\n', [':2', 'solver.step_budget_ms = 0', '(0, 1000000]']),
                (BLOCK + 'element: {strain: green}\nsolver: {kind: factor}\n', [':3', 'solver.kind = factor', 'corotated']),
                (BLOCK + 'node: {clock: slow}\n', ['realtime, lockstep']),
                (BLOCK + 'tools: [{name: a}, {name: a}]\n', ['a']),
                ('mesh: {file: {path: no_such_mesh.msh}}\n', [':1', 'mesh.file.path', 'no_such_mesh.msh', 'tried']),
                ('mesh: {file: {path: /dev/null}}\n', ['mesh.file.path', '/dev/null']),
        ]:
            with self.subTest(text=text):
                self.refuse('polyscalpel_node', '_scene:=', text, *words)

    def say(self, name, text):
        """What a node says of a scene that it takes: its status, the values of its diagnostics, its output."""
        executable = roslib.packages.find_node('polyscalpel', 'polyscalpel_node')[0]
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write(text)
            file.flush()
            node = subprocess.Popen([executable, '__ns:=/' + name, '__name:=' + name, '_scene:=' + file.name],
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            try:
                listener = Listener(namespace='/' + name + '/')
                wait_until(lambda: listener.diagnostics, 'diagnostics')
                for subscriber in listener.subscribers:
                    subscriber.unregister()
            finally:
                node.send_signal(signal.SIGINT)
                output = node.communicate(timeout=PATIENCE_S)[0]
        values = {value.key: value.value for value in listener.diagnostics[-1].status[0].values}
        return listener.status[-1], values, output

    def test_a_budget_is_left_out_in_lockstep_unless_asked(self):
        scene = BLOCK + 'solver: {step_budget_ms: 5}\nnode: {clock: lockstep, budget_in_lockstep: %s}\n'
        status, values, output = self.say('left_out', scene % 'false')
        self.assertTrue(status.budget_left_out)
        self.assertEqual(values['budget_left_out'], 'true')
        self.assertIn('solver.step_budget_ms = 5 is left out', output)
        status, values, output = self.say('kept', scene % 'true')
        self.assertFalse(status.budget_left_out)
        self.assertEqual(values['budget_left_out'], 'false')
        self.assertNotIn('WARN', output)

    def test_more_threads_than_cores_are_taken_and_told(self):
        threads = min(os.cpu_count() + 1, 256)
        _, _, output = self.say('threads', BLOCK + 'solver: {threads: %d}\nnode: {start_paused: true}\n' % threads)
        if os.cpu_count() < threads:
            self.assertIn('solver.threads = %d: this machine has' % threads, output)

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
