# SPDX-License-Identifier: MIT
# Proves that openings of Python let in and out what those of C++ do, in runs and single steps, and after restarts.
"""Openings of flows, through which water enters and leaves."""

import math
import pathlib
import tempfile
import unittest

import numpy as np
from simulations import bits, floating_box, grains, water

import silt

NAN, INF = math.nan, math.inf
L0 = 0.02
SPEED = 1.5  # [m/s]


def section(x, height=0.2):
    return [[(x, 0), (x, height)]]


def channel(**further):
    """A dry channel, into which fast water flows and out of which it falls."""
    arguments = {"position": [(0.11, 0.01)], "velocity": (SPEED, 0), "tank": (1, 0.4), "openings": [
        silt.Inflow(faces=section(0.1), velocity=(SPEED, 0), level=0.1),
        silt.Outflow(lower=(0.6, -INF), upper=(INF, INF))]}
    return water(**(arguments | further))


def basin(openings, **further):
    """Water 0.1 m deep between two openings."""
    return water(position=silt.lattice((0.1, 0), (0.5, 0.1), L0), tank=(0.6, 0.4), openings=openings, **further)


class Openings(unittest.TestCase):
    def test_let_in_and_out_the_volume_of_their_velocity(self):
        one = channel()
        one.run(until=0.5)
        entered, left = one.openings
        self.assertAlmostEqual(entered.volume, SPEED * 0.1 * 0.5, delta=1.2 * 0.1 * L0)  # a layer, and a step
        self.assertEqual(entered.removed + left.added, 0)
        self.assertAlmostEqual(left.volume, -left.removed * L0**2)
        self.assertGreater(left.removed, 10)
        self.assertEqual(len(one), 1 + entered.added - left.removed)

    def test_act_before_each_step(self):
        run, steps = channel(), channel()
        run.run(until=0.05, time_step=1e-3)
        steps.step(run.steps, time_step=1e-3)
        self.assertGreater(run.openings[0].added, 10)
        self.assertEqual(run.openings, steps.openings)
        self.assertEqual(bits(run), bits(steps))

    def test_of_two_velocities_keep_what_is_between_them(self):
        duct = basin([silt.Inflow(faces=section(0.1, 0.1), velocity=(0.5, 0)),
                      silt.Extraction(faces=section(0.5, 0.1), velocity=(0.5, 0))],
                     gravity=(0, -1e-3), velocity=(0.5, 0), walls=[[(0.6, 0.1), (0, 0.1)]])
        duct.run(until=0.2)
        np.testing.assert_allclose(duct["velocity"][:], np.broadcast_to((0.5, 0), (len(duct), 2)), atol=1e-3)
        self.assertEqual(duct.openings[0].added, duct.openings[1].removed)

    def test_of_a_pressure_keep_water_at_rest_or_let_it_in(self):
        def sides(level):
            return [silt.PressureOpening(faces=section(0.1), inwards=(1, 0), level=level),
                    silt.PressureOpening(faces=section(0.5), inwards=(-1, 0), level=0.1)]

        still, driven = basin(sides(0.1)), basin(sides(0.13))
        for simulation in (still, driven):
            simulation.run(until=0.2)
        self.assertLess(np.abs(still["velocity"]).max(), 0.02)
        self.assertGreater(driven["velocity"][:, 0].mean(), 0.1)

    def test_continue_from_checkpoints_with_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            one, other = channel(), channel()
            one.run(until=0.1)
            one.write_checkpoint(file)
            one.run(until=0.2)
            other.read_checkpoint(file)
            other.run(until=0.2)
            self.assertEqual(bits(one), bits(other))
            self.assertEqual(one.openings, other.openings)
            for different in (channel(openings=()), water()):
                with self.assertRaises(silt.Error):
                    different.read_checkpoint(file)

    def test_leave_the_numbers_of_bodies_and_walls(self):
        faces = silt.faces_of_box((0.2, 0.05), (0.4, 0.15))
        x = silt.remove_inside(silt.lattice((0.1, 0), (0.6, 0.1), L0), faces, L0)
        floating = water(position=x, bodies=silt.FloatingBody(faces=faces, density=500),
                         openings=silt.Inflow(faces=section(0.1), velocity=(0.01, 0), level=0.1))
        floating.run(until=0.1)
        self.assertGreater(floating.body_load(0)[0][1], 0)
        with self.assertRaisesRegex(silt.Error, "there are 0"):
            floating.wall_load(0)

    def test_are_of_3d(self):
        faces = [[(0.1, 0, 0), (0.1, 0.1, 0), (0.1, 0.1, 0.1)], [(0.1, 0, 0), (0.1, 0.1, 0.1), (0.1, 0, 0.1)]]
        entering = silt.flow_simulation(
            position=[(0.11, 0.01, 0.01)], velocity=(SPEED, 0, 0), spacing=L0, tank=(0.6, 0.1, 0.2), speed_scale=2,
            openings=[silt.Inflow(faces=faces, velocity=(SPEED, 0, 0)),
                      silt.Outflow(lower=(0.3, -INF, -INF), upper=(INF, INF, INF))])
        entering.run(until=0.05)
        self.assertAlmostEqual(entering.openings[0].volume, SPEED * 0.1**2 * 0.05, delta=1.2 * 0.1**2 * L0)

    def test_refuse_bad_arguments(self):
        inflow = {"faces": section(0.1), "velocity": (1, 0)}
        pressure = {"faces": section(0.1), "inwards": (1, 0), "level": 0.1}
        for make in (lambda: silt.Inflow(**(inflow | {"faces": section(0.1)[0]})),
                     lambda: channel(openings=silt.Inflow(**(inflow | {"faces": np.zeros((0, 2, 2))}))),
                     lambda: channel(openings=silt.Inflow(**(inflow | {"faces": np.zeros((1, 3, 3))}))),
                     lambda: channel(openings=silt.Inflow(**inflow | {"velocity": (1, 1)})),
                     lambda: channel(openings=silt.Inflow(**inflow | {"velocity": (0, 0)})),
                     lambda: channel(openings=silt.Inflow(**inflow, level=NAN)),
                     lambda: channel(openings=silt.Inflow(**inflow, level=-1)),
                     lambda: channel(openings=silt.Extraction(**inflow, ramp=-1)),
                     lambda: silt.Extraction(**inflow, start="now"),
                     lambda: silt.Outflow(lower=0, upper=(1, 1)),
                     lambda: channel(openings=silt.Outflow(lower=(1, 0), upper=(0, 1))),
                     lambda: channel(openings=silt.Outflow(lower=(-INF, -INF), upper=(INF, INF))),
                     lambda: channel(openings=silt.PressureOpening(**(pressure | {"inwards": (0, 0)}))),
                     lambda: channel(openings=silt.PressureOpening(**(pressure | {"level": NAN}))),
                     lambda: channel(openings=silt.PressureOpening(**pressure, density=-1)),
                     lambda: channel(openings=[3]), lambda: channel(openings=silt.Inflow),
                     lambda: grains().openings):
            with self.assertRaises(silt.Error) as caught:
                make()
            self.assertRegex(str(caught.exception), r"[a-z]+.*[;:]", "names the quantity, and what to do")
        self.assertEqual(water().openings, ())
        self.assertEqual(floating_box().openings, ())


if __name__ == "__main__":
    unittest.main()
