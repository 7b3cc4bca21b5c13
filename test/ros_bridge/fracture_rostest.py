#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The plate of config/scenes/plate.yaml hangs until it is notched, and then tears in two, as its events and status tell."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
import yaml
from genpy.message import fill_message_args
from polyscalpel.srv import CutRequest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import HERE, PATIENCE_S, Listener, Services, digest, shapes, wait_until  # noqa: E402

SCENE = os.path.join(os.path.dirname(os.path.dirname(HERE)), 'config', 'scenes', 'plate.yaml')
STEPS = 63
STEPS_A_MESH = 7  # 30 Hz of simulated time at 5 ms a step
VOLUME_M3 = 0.08 * 0.02 * 0.1
LIGAMENT_M2 = 0.04 * 0.02  # what the notch leaves of the plate's width, times its thickness


class Plate:
    """The plate of one node, paused: the service makes its steps, so lockstep needs no poses."""

    def __init__(self, namespace=''):
        self.services = Services(namespace)
        self.listener = Listener(namespace=namespace)
        self.services.set_paused(True)
        self.wait_for_meshes(2)

    def wait_for_meshes(self, count):
        """Each is waited for, so that the last one that has come is the present state's."""
        wait_until(lambda: len(self.listener.mesh) == count, 'mesh %d' % count)

    def reset(self):
        """The plate at rest, and nothing in the lists."""
        meshes = len(self.listener.mesh)
        if not self.services.reset().success:
            raise AssertionError('no reset')
        wait_until(lambda: (self.listener.status[-1].step, self.listener.status[-1].cuts) == (0, 0), 'the reset')
        self.wait_for_meshes(meshes + 1)
        self.listener.clear()

    def notch(self):
        """The cut that the scene's comment gives; returns the status after it."""
        with open(SCENE, encoding='utf-8') as file:
            arguments = re.search(r'rosservice call /cut "(.*)"', file.read()).group(1)
        request = CutRequest()
        fill_message_args(request, [yaml.safe_load(arguments)])
        meshes = len(self.listener.mesh)
        response = self.services.cut(request)
        if not response.success:
            raise AssertionError(response.message)
        wait_until(lambda: self.listener.status and self.listener.status[-1].cuts == 1 and self.listener.cuts, 'the notch')
        self.wait_for_meshes(meshes + 1)
        return self.listener.status[-1]

    def step(self):
        """Makes STEPS steps and returns their statuses."""
        meshes, begin = len(self.listener.mesh), len(self.listener.status)
        response = self.services.step(STEPS)
        if not response.success:
            raise AssertionError(response.message)
        wait_until(lambda: len(self.listener.status) == begin + STEPS, 'the steps')
        wait_until(lambda: sum(event.cells_split for event in self.cracks()) == self.listener.status[-1].fracture_splits,
                   'the events')
        self.wait_for_meshes(meshes + STEPS // STEPS_A_MESH + 1)
        return self.listener.status[begin:]

    def cracks(self):
        return [event for event in self.listener.cuts if event.source == 'fracture']

    def run_notched(self):
        """What can be seen of a run from the start on, notched before its first step, and of its end; no wall times."""
        self.reset()
        self.notch()
        self.step()
        return digest(self.listener.cuts), digest(self.listener.mesh), shapes(self.listener.mesh[-1])


class FractureTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('fracture_rostest')
        cls.plate = Plate()

    def start(self, namespace, replacement):
        """A plate in a node of its own, with another line for the scene's option."""
        with open(SCENE, encoding='utf-8') as file:
            text = file.read()
        self.assertEqual(text.count('\nfracture: {}\n'), 1)
        scene = tempfile.NamedTemporaryFile('w', suffix='.yaml')
        self.addCleanup(scene.close)
        scene.write(text.replace('\nfracture: {}\n', '\n%s\n' % replacement))
        scene.flush()
        executable = roslib.packages.find_node('polyscalpel', 'polyscalpel_node')[0]
        node = subprocess.Popen([executable, '__ns:=/' + namespace, '_scene:=' + scene.name, '_clock:=lockstep'])
        self.addCleanup(node.wait, PATIENCE_S)
        self.addCleanup(node.terminate)
        return Plate(namespace + '/')

    def test_it_hangs_until_it_is_notched(self):
        self.plate.reset()
        for status in self.plate.step():
            self.assertEqual((status.fracture_splits, status.pieces, status.cuts, status.fracture_limited), (0, 1, 0, False))
            self.assertGreater(status.fracture_s, 0)
        self.assertEqual(self.plate.listener.cuts, [])
        self.plate.notch()
        self.assertEqual(self.plate.step()[-1].pieces, 2)

    def test_a_notched_plate_tears_in_two_and_says_so(self):
        self.plate.reset()
        state = self.plate.notch()
        statuses = self.plate.step()
        end = statuses[-1]
        self.assertIn('fracture', end.parts)
        self.assertEqual((end.pieces, end.cuts), (2, 2), 'the notch, and one crack from both of its ends')
        self.assertEqual((end.fracture_left_whole, end.cells_left_whole), (0, 0))
        self.assertAlmostEqual(end.fracture_area_m2, LIGAMENT_M2, delta=0.03 * LIGAMENT_M2)
        self.assertLess(end.volume_relative_error, 1e-12)
        self.assertTrue(all(status.converged for status in statuses))

        notch, *cracks = self.plate.listener.cuts
        self.assertEqual((notch.source, notch.cut, notch.pieces_after), ('service', 1, 1))
        self.assertGreater(len(cracks), 1, 'a crack takes a step for each cell on its way')
        after = {status.time_s: status for status in statuses}
        for event in cracks:
            self.assertEqual((event.source, event.cut, event.cuts, event.header.frame_id), ('fracture', 2, 1, 'world'))
            self.assertEqual((event.cells_left_whole, event.debris_pieces), (0, 0))
            self.assertEqual(set(event.child_parents), set(event.parents))
            self.assertEqual(len(event.children) - len(event.parents), event.cells_split)
            self.assertGreater(event.new_faces, 0)
            self.assertAlmostEqual(sum(piece.volume_m3 for piece in event.pieces), VOLUME_M3, delta=1e-12 * VOLUME_M3)
            change = event.momentum_change
            self.assertLess(max(abs(change.x), abs(change.y), abs(change.z)), 1e-14, 'of some 3 kg at 0.05 m/s')
            self.assertLess(event.kinetic_energy_change_j, 1e-14)
            before, state = state, after[event.time_s]
            self.assertEqual((event.pieces_before, event.pieces_after), (before.pieces, state.pieces))
            self.assertEqual(event.cells_split, state.cells - before.cells)
            self.assertEqual(event.cells_split, state.fracture_splits - before.fracture_splits)
            self.assertAlmostEqual(event.cut_area_m2, state.fracture_area_m2 - before.fracture_area_m2, 15)
        self.assertEqual((state.cells, state.pieces), (end.cells, end.pieces), 'nothing has split without an event')

    def test_the_same_run_again_and_in_another_node_is_the_same_to_the_bit(self):
        first = self.plate.run_notched()
        self.assertEqual(self.plate.run_notched(), first)
        self.assertEqual(self.start('other', 'fracture: {}').run_notched(), first)

    def test_no_more_cells_split_in_a_step_than_the_scene_allows(self):
        limit = 2
        slow = self.start('slow', 'fracture: {max_splits_per_step: %d}' % limit)
        slow.notch()
        statuses = slow.step()
        splits = [0] + [status.fracture_splits for status in statuses]
        in_step = [after - before for before, after in zip(splits, splits[1:])]
        self.assertEqual(max(in_step), limit)
        self.assertEqual({count for status, count in zip(statuses, in_step) if status.fracture_limited}, {limit})
        self.assertEqual(statuses[-1].pieces, 2)

    def test_without_the_option_nothing_tears(self):
        held = self.start('held', '')
        notched = held.notch()
        for status in held.step():
            self.assertNotIn('fracture', status.parts)
            self.assertEqual((status.pieces, status.cuts, status.cells), (1, 1, notched.cells))
            self.assertEqual((status.fracture_splits, status.fracture_area_m2, status.fracture_s), (0, 0, 0))
        self.assertEqual([event.source for event in held.listener.cuts], ['service'])


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'fracture', FractureTest)
