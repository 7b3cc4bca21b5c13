#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The services of a paused node: cut, step, set_paused, reset, and what they refuse."""
import math
import os
import sys
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from polyscalpel.msg import CutPolygon, CutSweep
from std_msgs.msg import Header

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bridge_testing import Listener, Services, namespaces, shapes, wait_until  # noqa: E402


class ServicesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('services_rostest')
        cls.services = Services()
        cls.listener = Listener()
        cls.start = shapes(cls.listener.mesh[0])

    def setUp(self):
        self.services.set_paused(True)
        self.assertTrue(self.services.reset().success)
        wait_until(lambda: self.listener.status[-1].cells == 27 and self.listener.status[-1].step == 0, 'the reset')
        self.listener.clear()

    def cut_plane(self, point, normal, **others):
        return self.services.cut(plane_points=[Point(*point)], plane_normals=[Vector3(*normal)], **others)

    def mesh_now(self):
        """The mesh of the present state, not one that was still under way."""
        asked = rospy.Time.now()
        self.services.set_paused(True)  # publishes the mesh
        wait_until(lambda: self.listener.mesh and self.listener.mesh[-1].markers[0].header.stamp >= asked, 'the mesh')
        return shapes(self.listener.mesh[-1])

    def test_a_plane_makes_two_pieces_and_status_agrees(self):
        response = self.cut_plane((0.015, 0, 0), (1, 0, 0))
        self.assertTrue(response.success, response.message)
        self.assertEqual((response.pieces_before, response.pieces, response.cells, response.cells_split), (1, 2, 36, 9))
        self.assertAlmostEqual(response.cut_area_m2, 9e-4, 12)
        wait_until(lambda: self.listener.status and self.listener.status[-1].cuts == 1 and self.listener.cuts, 'the cut')
        status = self.listener.status[-1]
        self.assertEqual((status.pieces, status.cells, status.cells_left_whole), (2, 36, 0))
        self.assertLess(status.volume_relative_error, 1e-12)
        self.assertEqual(status.header.frame_id, 'world')
        self.assertEqual(set(status.parts) & {'mesh', 'elements', 'cutting'}, {'mesh', 'elements', 'cutting'})
        self.assertNotIn('contact', status.parts)

        event = self.listener.cuts[-1]
        self.assertEqual((event.source, event.header.frame_id, event.pieces_before, event.pieces_after),
                         ('service', 'world', 1, 2))
        self.assertEqual(len(event.parents), 9)
        self.assertEqual(len(event.children), 18)
        self.assertEqual(set(event.child_parents), set(event.parents))
        self.assertEqual(event.new_faces, 18)
        self.assertEqual((event.cut, event.cuts, event.debris_pieces), (1, 1, 0))
        self.assertEqual([piece.cells for piece in event.pieces], [18, 18])
        for piece in event.pieces:
            self.assertAlmostEqual(piece.volume_m3, 1.35e-5, 17)
            self.assertAlmostEqual(piece.mass_kg, 1000 * piece.volume_m3, 14)
        self.assertAlmostEqual(status.shortest_edge_m, 0.005, 12)
        self.assertAlmostEqual(status.shortest_edge_relative, 0.5, 12)
        self.assertAlmostEqual(status.smallest_cell_volume_relative, 0.5, 12)
        self.assertGreater(status.condition_estimate, 1)

        self.mesh_now()
        self.assertEqual(namespaces(self.listener.mesh[-1]), {'surface', 'cut_faces', 'wireframe', 'pieces'})
        labels = [m.text for m in self.listener.mesh[-1].markers if m.ns == 'pieces']
        self.assertEqual(labels, ['piece 1: 13.5 ml', 'piece 2: 13.5 ml'])
        for marker in self.listener.mesh[-1].markers:
            self.assertEqual(marker.header.frame_id, 'world')

    def test_the_stress_is_told_and_shown(self):
        def latest(step):
            wait_until(lambda: self.listener.status and self.listener.status[-1].step == step, 'step %d' % step)
            return self.listener.status[-1]

        def surface_colours():
            self.mesh_now()
            surface = next(m for m in self.listener.mesh[-1].markers if m.ns == 'surface')
            self.assertEqual(len(surface.colors), len(surface.points))
            return [(c.r, c.g, c.b) for c in surface.colors]

        self.mesh_now()
        self.assertNotIn('colours', namespaces(self.listener.mesh[-1]), 'there is no stress before the first step')
        plain = surface_colours()
        self.assertTrue(all(r > b for r, _, b in plain))
        self.assertTrue(math.isnan(latest(0).error_estimate))
        self.assertEqual(latest(0).stress_s, 0)

        self.assertTrue(self.services.step(20).success)
        status = latest(20)
        self.assertIn('stress', status.parts)
        self.assertTrue(0 < status.error_estimate < 1, status.error_estimate)
        # A block of 3 cm bears at its bottom 1000 kg/m^3 x 9.81 m/s^2 x 0.03 m = 294 Pa.
        self.assertTrue(30 < status.von_mises_max_pa < 600, status.von_mises_max_pa)
        self.assertGreater(status.stress_s, 0)
        coloured = surface_colours()
        self.assertTrue(any(b > r for r, _, b in coloured), 'the lowest values are blue')
        self.assertTrue(any(r > 2 * b for r, _, b in coloured), 'higher ones red to yellow')
        label = next(m.text for m in self.listener.mesh[-1].markers if m.ns == 'colours')
        self.assertRegex(label, r'^von Mises stress .* to .* Pa$')
        self.assertAlmostEqual(float(label.split()[-2]), status.von_mises_max_pa, delta=0.01 * status.von_mises_max_pa)

        self.assertTrue(self.cut_plane((0.015, 0, 0), (1, 0, 0)).success)
        wait_until(lambda: latest(20).cuts == 1, 'the cut')
        self.assertTrue(math.isnan(latest(20).von_mises_max_pa), 'of the mesh before the cut')
        self.assertTrue(self.services.step(1).success)
        self.assertGreater(latest(21).von_mises_max_pa, 0)
        self.mesh_now()
        cut_faces = next(m for m in self.listener.mesh[-1].markers if m.ns == 'cut_faces')
        self.assertTrue(any(c.b > c.r for c in cut_faces.colors) or any(c.r > 2 * c.b for c in cut_faces.colors))

    def test_three_planes_make_sixty_cells_and_six_pieces(self):
        response = self.services.cut(plane_points=[Point(0.005, 0, 0), Point(0.015, 0, 0), Point(0, 0.015, 0)],
                                     plane_normals=[Vector3(1, 0, 0), Vector3(2, 0, 0), Vector3(0, -1, 0)])
        self.assertTrue(response.success, response.message)
        self.assertEqual((response.cuts, response.cells, response.pieces), (3, 60, 6))
        wait_until(lambda: self.listener.cuts, 'the event')
        event = self.listener.cuts[-1]
        self.assertEqual((event.cut, event.cuts, event.pieces_before, event.pieces_after), (1, 3, 1, 6))

    def test_a_list_of_all_kinds_is_one_transaction(self):
        upright = Quaternion(0, 0, 0, 1)
        across = [Point(-1, 0.015, -1), Point(1, 0.015, -1), Point(1, 0.015, 1), Point(-1, 0.015, 1)]
        sweep = CutSweep(edge=[Point(0, 0, 0), Point(0, 0.06, 0)],
                         poses=[Pose(Point(-0.01, -0.01, 0.017), upright), Pose(Point(0.05, -0.01, 0.017), upright)])
        response = self.services.cut(plane_points=[Point(0.015, 0, 0)], plane_normals=[Vector3(1, 0, 0)],
                                     polygons=[CutPolygon(corners=across)], sweeps=[sweep])
        self.assertTrue(response.success, response.message)
        self.assertEqual((response.cuts, response.pieces), (3, 8))
        wait_until(lambda: self.listener.cuts, 'the event')
        event = self.listener.cuts[-1]
        self.assertEqual((event.cuts, len(event.pieces)), (3, 8))
        self.assertAlmostEqual(sum(piece.volume_m3 for piece in event.pieces), 2.7e-5, 15)

    def test_debris_is_taken_away_and_told_of(self):
        response = self.cut_plane((0.002, 0, 0), (1, 1, 1))  # a corner with edges of 2 mm
        self.assertTrue(response.success, response.message)
        self.assertEqual((response.debris_pieces, response.pieces, response.cells), (1, 1, 27))
        self.assertAlmostEqual(response.debris_volume_m3, 0.002 ** 3 / 6, 20)
        wait_until(lambda: self.listener.status and self.listener.status[-1].cuts == 1 and self.listener.cuts, 'the cut')
        event, status = self.listener.cuts[-1], self.listener.status[-1]
        self.assertEqual((event.pieces_after, event.debris_pieces, len(event.debris_cells)), (2, 1, 1))
        self.assertIn(event.debris_cells[0], event.children)
        self.assertAlmostEqual(event.debris_mass_kg, 1000 * response.debris_volume_m3, 16)
        self.assertEqual([piece.cells for piece in event.pieces], [27])
        self.assertEqual(status.debris_pieces, 1)
        self.assertEqual(status.debris_volume_m3, response.debris_volume_m3)
        self.assertLess(status.volume_relative_error, 1e-12)
        self.assertTrue(self.services.step(10).success)
        self.assertNotEqual(self.mesh_now(), self.start)
        self.assertTrue(self.services.reset().success)
        self.assertEqual(self.mesh_now(), self.start)
        wait_until(lambda: self.listener.status[-1].step == 0, 'the reset')
        self.assertEqual(self.listener.status[-1].debris_pieces, 0)

    def test_polygon_and_sweep_cut_too(self):
        corners = [Point(0.015, -1, -1), Point(0.015, 1, -1), Point(0.015, 1, 1), Point(0.015, -1, 1)]
        response = self.services.cut(polygon=corners)
        self.assertTrue(response.success, response.message)
        self.assertEqual(response.pieces, 2)
        upright = Quaternion(0, 0, 0, 1)
        response = self.services.cut(sweep_edge=[Point(0, 0, -0.01), Point(0, 0, 0.05)],
                                     sweep_poses=[Pose(Point(-0.01, 0.012, 0), upright), Pose(Point(0.05, 0.018, 0), upright)])
        self.assertTrue(response.success, response.message)
        self.assertEqual(response.pieces, 4)

    def test_bad_requests_are_refused_with_a_reason(self):
        nan = float('nan')
        upright = Quaternion(0, 0, 0, 1)
        cases = [
            ('no cut', dict()),
            ('longer than 0', dict(plane_points=[Point(0, 0, 0)], plane_normals=[Vector3(0, 0, 0)])),
            ('finite', dict(plane_points=[Point(nan, 0, 0)], plane_normals=[Vector3(1, 0, 0)])),
            ('finite', dict(plane_points=[Point(0, 0, 0)], plane_normals=[Vector3(math.inf, 0, 0)])),
            ('plane_normals', dict(plane_points=[Point(0, 0, 0)])),
            ('3 corners', dict(polygon=[Point(0, 0, 0)])),
            ('', dict(polygon=[Point(0, 0, 0), Point(0, 0, 1), Point(0, 0, 2)])),
            ('', dict(polygon=[Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0.5), Point(0, 1, 0)])),
            ('at least 2', dict(sweep_edge=[Point(0, 0, 0)], sweep_poses=[Pose(Point(0, 0, 0), upright)] * 2)),
            ('unit quaternion', dict(sweep_edge=[Point(0, 0, 0), Point(0, 0, 1)], sweep_poses=[Pose(), Pose()])),
            ('sweep_edge', dict(polygon=[Point(0, 0, 0)] * 3, sweep_edge=[Point(0, 0, 0)])),
            ('polygons[0].corners', dict(polygons=[CutPolygon()])),
            # Nothing of a list is made where one of it is no cut, misses or is too long.
            ('cut 2 of 2', dict(plane_points=[Point(0.015, 0, 0)], plane_normals=[Vector3(1, 0, 0)],
                                polygon=[Point(0, 0, 0), Point(1, 1, 0), Point(1, 0, 0), Point(0, 1, 0)])),
            ('cut 2 of 3', dict(plane_points=[Point(x, 0, 0) for x in (0.015, 1, 0.005)],
                                plane_normals=[Vector3(1, 0, 0)] * 3)),
            ('sub-steps', dict(sweep_edge=[Point(0, 0, -1), Point(0, 0, 1)],
                               sweep_poses=[Pose(Point(-1e6, 0.015, 0), upright), Pose(Point(1, 0.015, 0), upright)])),
            ('1e9 m', dict(plane_points=[Point(1e10, 0, 0)], plane_normals=[Vector3(1, 0, 0)])),
            ('', dict(plane_points=[Point(1, 0, 0)], plane_normals=[Vector3(1, 0, 0)])),  # misses
        ]
        for words, request in cases:
            with self.subTest(request=str(request)):
                response = self.services.cut(**request)
                self.assertFalse(response.success)
                self.assertTrue(response.message)
                self.assertIn(words, response.message)
                self.assertEqual((response.cuts, response.pieces, response.cells), (0, 1, 27))
        request_header = Header(frame_id='nowhere')
        response = self.cut_plane((0.015, 0, 0), (1, 0, 0), header=request_header)
        self.assertFalse(response.success)
        self.assertIn('nowhere', response.message)
        self.assertEqual(self.mesh_now(), self.start)

    def test_reset_restores_the_start_bit_for_bit(self):
        self.assertTrue(self.cut_plane((0.015, 0, 0), (1, 0.2, 0)).success)
        self.assertTrue(self.services.step(20).success)
        self.assertNotEqual(self.mesh_now(), self.start)
        self.assertTrue(self.services.reset().success)
        self.assertEqual(self.mesh_now(), self.start)
        wait_until(lambda: self.listener.status[-1].step == 0, 'the reset')
        status = self.listener.status[-1]
        self.assertEqual((status.cells, status.pieces, status.cuts, status.time_s), (27, 1, 0, 0))

    def test_runs_after_a_reset_are_the_same_bit_for_bit(self):
        runs = []
        for _ in range(2):
            self.services.reset()
            self.assertTrue(self.cut_plane((0.015, 0, 0), (1, 0.2, 0)).success)
            self.assertTrue(self.services.step(15).success)
            runs.append(self.mesh_now())
        self.assertEqual(runs[0], runs[1])

    def test_steps_only_while_paused_and_in_range(self):
        response = self.services.step(5)
        self.assertTrue(response.success, response.message)
        self.assertEqual(response.step, 5)
        self.assertAlmostEqual(response.time_s, 0.05, 12)
        for steps in (0, 100001):
            response = self.services.step(steps)
            self.assertFalse(response.success)
            self.assertIn('[1, 100000]', response.message)
        self.assertEqual(self.services.set_paused(False).message, 'running')
        response = self.services.step(5)
        self.assertFalse(response.success)
        self.assertIn('pause', response.message)
        wait_until(lambda: self.listener.status[-1].step > 10, 'steps')
        self.assertEqual(self.services.set_paused(True).message, 'paused')
        self.assertEqual(self.services.set_paused(True).message, 'was paused already')

    def test_stages_that_the_scene_does_not_build_take_no_time(self):
        self.assertTrue(self.services.step(3).success)
        wait_until(lambda: self.listener.status and self.listener.status[-1].step == 3, 'the steps')
        status = self.listener.status[-1]
        self.assertEqual((status.detection_s, status.contact_s), (0, 0))
        self.assertGreater(status.solve_s, 0)
        self.assertTrue(status.converged)

    def test_diagnostics_name_the_simulation(self):
        wait_until(lambda: self.listener.diagnostics, 'diagnostics')
        names = [entry.name for entry in self.listener.diagnostics[-1].status]
        self.assertEqual(names, ['polyscalpel: simulation'])


if __name__ == '__main__':
    rostest.rosrun('polyscalpel', 'services', ServicesTest)
