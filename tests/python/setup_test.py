# SPDX-License-Identifier: MIT
"""Making simulations, also from what is none of a simulation; and their measures."""

import copy
import math
import pickle
import unittest

import numpy as np
from simulations import LAW, R, bits, grains, spheres, water

import silt

NAN, INF = math.nan, math.inf


class Setup(unittest.TestCase):
    def check_refused(self, make, name, values):
        for value in values:
            with self.assertRaises(silt.Error, msg=f"{name} = {value!r}") as caught:
                make(**{name: value})
            self.assertRegex(str(caught.exception), r"[a-z]+.*[;:]", "names the quantity, and what to do")

    def test_of_grains_refuses_bad_arguments(self):
        x = silt.lattice((-0.08, 0.1), (0.08, 0.3), 2 * R)
        bad_point = x.copy()
        bad_point[3, 1] = NAN
        self.check_refused(grains, "position", [x.T, x[0], 1, None, "here", [], [[1]], x + 1j, bad_point, x[:, :1],
                                                [[1, 2], [3]], np.zeros((2, 4)), np.full((2, 2), INF), x[None],
                                                object(), x.astype("U9")])
        self.check_refused(grains, "velocity", [x[1:], 1j, "fast", np.zeros((20, 3)), np.zeros(3), [[1], [2]],
                                                INF, (0, NAN)])
        self.check_refused(grains, "radius", [-1, 0, NAN, INF, 1e-200, 1e200, [], np.full(19, R), np.full((20, 1), R),
                                              None, "small", [R] * 19 + [-R]])
        self.check_refused(grains, "density", [-1, 0, NAN, INF, [], None])
        self.check_refused(grains, "gravity", [(0, 0, -9.81), 9.81, (0, NAN), "down", (0, INF)])
        self.check_refused(grains, "damping", [-1, NAN, INF, None, (1, 2)])
        self.check_refused(grains, "steps_per_contact", [0, -1, NAN, INF, "many"])
        self.check_refused(grains, "max_overlap", [0, -1, NAN])
        self.check_refused(grains, "law", [None, 3, silt.CundallStrack, silt.Plane(normal=(0, 1)), "Hertz"])
        self.check_refused(grains, "box", [1, ((0, 0), (1, 1)), silt.Box(lower=(0, 0, 0), upper=(1, 1, 1)),
                                           silt.Box(lower=(1, 1), upper=(0, 0)), silt.Box(lower=(NAN, 0), upper=(1, 1)),
                                           silt.Box(lower=(0, -INF), upper=(1, 1), periodic=(False, True))])
        floor = silt.Plane(normal=(0, 1))
        self.check_refused(grains, "walls", [3, None, [None], [floor, LAW], [floor] * 9, "floor", [silt.Plane],
                                             [silt.Plane(normal=(0, 0, 1))], [silt.Plane(normal=(0, 0))],
                                             [silt.Cylinder(start=(0, 0, 0), end=(0, 0, 1), radius=1)],
                                             [silt.Circle(centre=(0, 0), radius=0)],
                                             [silt.Segment(start=(0, 0), end=(0, 0))],
                                             [silt.Polyline(points=[(0, 0)])],
                                             [silt.BoxWall(lower=(0, 0), upper=(0, 1))]])
        self.check_refused(spheres, "walls", [[floor], [silt.Circle(centre=(0, 0), radius=1)],
                                              [silt.MeshWall(triangles=np.zeros((1, 3, 3)))],
                                              [silt.MeshWall(triangles=np.zeros((0, 3, 3)))]])
        with self.assertRaisesRegex(silt.Error, "spacing"):
            water(spacing=0.05).step()
        with self.assertRaises(TypeError):
            silt.grain_simulation(position=x)
        with self.assertRaises(TypeError):
            grains(colour="red")

    def test_of_flows_refuses_bad_arguments(self):
        x = silt.lattice((0, 0), (0.2, 0.3), 0.02)
        self.check_refused(water, "position", [x.T, x - 0.1, x + 0.5, None, [[NAN, 0.1]], np.zeros((2, 3)), 1j * x])
        self.check_refused(water, "spacing", [0, -1, NAN, INF, 10, None, [0.02, 0.02]])
        self.check_refused(water, "tank", [(1, 1, 1), 1, (0, 1), (-1, 1), (NAN, 1), (0.1, 0.5), None])
        self.check_refused(water, "density", [0, -1, NAN, INF])
        self.check_refused(water, "viscosity", [-1, NAN, INF])
        self.check_refused(water, "speed_scale", [-1, NAN, INF])
        self.check_refused(water, "gravity", [(0, 0, 1), (NAN, 0), 9.81])
        self.check_refused(water, "on_escape", ["delete", None, 3])
        self.check_refused(water, "velocity", [np.zeros((2, 2)), 1j, INF, (NAN, 0)])
        self.check_refused(water, "lid", ["no", 0, None])

    def test_tanks_are_where_they_were_asked_to_be(self):
        dam = water(tank=(0.61, 0.505))
        self.assertEqual(dam.wall_pressure((0.61, 0.1), (-1, 0)), 0)
        for aside in (0.6, 0.62):
            with self.assertRaisesRegex(silt.Error, "is on no wall"):
                dam.wall_pressure((aside, 0.1), (-1, 0))
        dam.run(until=0.01)
        with self.assertRaisesRegex(silt.Error, "outside of the tank"):
            water(tank=(0.18, 0.505))

    def test_gravity_out_of_the_tank_is_refused_in_the_first_step(self):
        with self.assertRaisesRegex(silt.Error, "no wall below it; change the gravity, or close the tank by lid=True"):
            water(gravity=(0, 9.81)).step()
        water(gravity=(0, 9.81), lid=True).step()

    def test_of_laws_refuses_bad_numbers(self):
        def with_law(**numbers):
            return grains(law=silt.CundallStrack(**({"normal_stiffness": 1e6, "tangential_stiffness": 5e5} | numbers)))

        def with_hertz(**numbers):
            return grains(law=silt.HertzMindlin(**({"young_modulus": 1e8, "poisson_ratio": 0.3} | numbers)))

        def with_spring(**numbers):
            return grains(law=silt.LinearSpringDashpot(
                **({"normal_stiffness": 1e6, "tangential_stiffness": 5e5} | numbers)))

        for make in (with_law, with_hertz, with_spring):
            self.check_refused(make, "restitution", [0, -1, 1.1, NAN, None])
            self.check_refused(make, "friction_angle", [-0.1, 1.6, NAN, "steep"])
            make(restitution=0.5, friction_angle=0.3).run(until=0.01)
        self.check_refused(with_law, "normal_stiffness", [0, -1, NAN, INF])
        self.check_refused(with_hertz, "young_modulus", [0, -1, NAN])
        self.check_refused(with_hertz, "poisson_ratio", [-1, 0.6, NAN])

    def test_of_parts_refuses_other_shapes(self):
        for make in (lambda: silt.Plane(normal=(1, 2, 3, 4)), lambda: silt.Plane(normal=1),
                     lambda: silt.BoxWall(lower=(0, 0), upper=(1, 1), grains="above"),
                     lambda: silt.Polyline(points=np.zeros((3, 3))), lambda: silt.MeshWall(triangles=np.zeros((3, 3))),
                     lambda: silt.Circle(centre=(0, 0), radius="wide"), lambda: silt.Box(lower=0, upper=1),
                     lambda: silt.Box(lower=(0, 0), upper=(1, 1), on_escape="ignore"),
                     lambda: silt.lattice((0, 0), (1, 1), 0), lambda: silt.lattice((0, 0), (1, 1, 1), 0.1),
                     lambda: silt.lattice((0, 0), (1, 1), 1e-9), lambda: silt.lattice((0, NAN), (1, 1), 0.1),
                     lambda: silt.lattice(0, 1, 0.1), lambda: silt.VtkSeries(None), lambda: silt.VtkSeries("a\0")):
            with self.assertRaises(silt.Error):
                make()

    def test_accepts_anything_of_numbers(self):
        x = [(0, 0.1), (0.5, 0.1)]
        one = grains(position=x, radius=[R, R], gravity=[0, -9.81])
        other = grains(position=np.asfortranarray(np.array(x, dtype=np.float64)), radius=np.full(4, R)[::2],
                       gravity=np.array([0, -9.81]), velocity=[0, 0])
        third = grains(position=np.repeat(x, 2, axis=0)[::2], density=np.int32(2500), walls=silt.Plane(normal=[0, 2]))
        for simulation in (one, other, third):
            simulation.run(until=0.02)
        self.assertEqual(bits(one), bits(other))
        self.assertEqual(bits(one), bits(third))

    def test_is_by_functions_alone(self):
        with self.assertRaises(TypeError):
            silt.Simulation()
        simulation = grains()
        for make in (copy.copy, copy.deepcopy, pickle.dumps):
            with self.assertRaises(TypeError):
                make(simulation)
        error = pickle.loads(pickle.dumps(silt.Error("the sentence")))
        self.assertEqual((type(error), error.what), (silt.Error, "the sentence"))
        self.assertTrue(issubclass(silt.Error, RuntimeError))
        for name in silt.__all__:
            self.assertTrue(getattr(silt, name).__doc__, name)


class Walls(unittest.TestCase):
    def test_of_every_kind_hold_a_grain(self):
        planes = {"point": (0, 0.0), "normal": (0, 3)}
        for wall in (silt.Plane(**planes), silt.BoxWall(lower=(-1, 0), upper=(1, INF)),
                     silt.BoxWall(lower=(-1, -1), upper=(1, 0), grains="outside"),
                     silt.Circle(centre=(0, 1), radius=1), silt.Segment(start=(-1, 0), end=(1, 0)),
                     silt.Polyline(points=[(-1, 1), (-1, 0), (1, 0), (1, 1)])):
            simulation = grains(position=[(0, 0.05)], walls=[wall], damping=5)
            simulation.run(until=1)
            self.assertAlmostEqual(simulation["position"][0, 1], R, delta=1e-4, msg=repr(wall))
            force, torque = simulation.wall_load(0)
            self.assertAlmostEqual(force[1], -9.81 * simulation["mass"][0], delta=1e-2)
            self.assertEqual((force.shape, torque.shape), ((2,), (1,)))
        square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
        for wall in (silt.Plane(normal=(0, 0, 1)), silt.BoxWall(lower=(-1, -1, 0), upper=(1, 1, INF)),
                     silt.Cylinder(start=(0, 0, 0), end=(0, 0, 1), radius=1, ends=True),
                     silt.MeshWall(triangles=square[[[0, 1, 2], [0, 2, 3]]])):
            simulation = spheres(position=[(0.1, 0.05, 0.05)], walls=[wall], damping=5)
            simulation.run(until=1)
            self.assertAlmostEqual(simulation["position"][0, 2], R, delta=1e-4, msg=repr(wall))
            self.assertEqual(simulation.wall_load(0)[1].shape, (3,))

    def test_that_are_absent_let_grains_pass(self):
        simulation = grains(position=[(0, 0.05)])
        self.assertTrue(simulation.is_wall_present(0))
        simulation.set_wall_present(0, False)
        self.assertFalse(simulation.is_wall_present(0))
        simulation.run(until=0.5)
        self.assertLess(simulation["position"][0, 1], 0)
        for bad in (1, 7, -1, "floor", 0.5):
            with self.assertRaises(silt.Error, msg=repr(bad)):
                simulation.set_wall_present(bad, True)
            with self.assertRaises(silt.Error):
                simulation.wall_load(bad)

    def test_periodic_sides_are_none(self):
        simulation = grains(box=silt.Box(lower=(-0.1, -INF), upper=(0.1, INF), periodic=(True, False)), velocity=(3, 0))
        simulation.run(until=0.2)
        x = simulation["position"][:, 0]
        self.assertTrue(((x >= -0.1) & (x < 0.1)).all())


class Measures(unittest.TestCase):
    def test_of_energy_are_conserved(self):
        elastic = silt.CundallStrack(normal_stiffness=1e6)
        for make in (grains, spheres):
            simulation = make(law=elastic, steps_per_contact=200)
            before = sum(simulation.energies().values())
            simulation.run(until=0.3)
            energies = simulation.energies()
            self.assertEqual(set(energies), {"kinetic", "rotational", "potential", "elastic"})
            self.assertGreater(energies["kinetic"], 0)
            self.assertAlmostEqual(sum(energies.values()) / before, 1, delta=1e-3)

    def test_of_water_at_rest(self):
        still = water(position=silt.lattice((0, 0), (0.6, 0.3), 0.02))
        still.run(until=0.3)
        self.assertAlmostEqual(still.wall_pressure((0.6, 0), (-1, 0)), 9810 * 0.3, delta=0.05 * 9810 * 0.3)
        x, height = still.front()
        self.assertAlmostEqual(x, 0.6, delta=0.01)
        self.assertAlmostEqual(height, 0.3, delta=0.01)
        mass = 1000 * 0.02**2
        self.assertAlmostEqual(still.energies()["potential"], 9.81 * mass * still["position"][:, 1].sum())

    def test_of_a_column_in_3d(self):
        dam = silt.flow_simulation(position=silt.lattice((0, 0, 0), (0.1, 0.1, 0.1), 0.02), spacing=0.02,
                                   tank=(0.3, 0.1, 0.2), speed_scale=1)
        dam.run(until=0.05)
        self.assertGreater(dam.front()[0], 0.1)
        self.assertLess(dam.energies()["potential"], 1000 * 0.1**3 * 9.81 * 0.05)

    def test_of_the_other_kind_are_refused(self):
        for call in (lambda: grains().front(), lambda: grains().wall_pressure((0, 0), (0, 1)),
                     lambda: water().wall_load(0), lambda: water().set_wall_present(0, False),
                     lambda: water().wall_pressure((0, 0), (0, 0)), lambda: water().wall_pressure((0, 0, 0), (0, 1)),
                     lambda: water().wall_pressure(0, 1), lambda: water().wall_pressure((50, 50), (-1, 0)),
                     lambda: water().wall_pressure((0.3, 0.2), (0, 1)),
                     lambda: water().wall_pressure((NAN, 0), (0, 1)), lambda: grains().set_wall_present(0, "no")):
            with self.assertRaises(silt.Error):
                call()

    def test_snapshots_are_in_the_order_of_ids(self):
        simulation = grains()
        simulation.remove([0, 4])
        simulation.run(until=0.3)
        state = simulation.snapshot()
        np.testing.assert_array_equal(state["id"], [i for i in range(20) if i not in (0, 4)])
        np.testing.assert_array_equal(state["position"], simulation["position"][:][np.argsort(simulation.ids)])
        self.assertEqual(set(state), set(simulation.fields) | {"id"})
        with self.assertRaises(silt.Error):
            simulation.remove(4)
        for bad in ([1, 4], -1, 0.5, "one", [[1]], 2**63):
            with self.assertRaises(silt.Error, msg=repr(bad)):
                simulation.remove(bad)
        self.assertEqual(len(simulation), 18)
        simulation.remove([])
        simulation.remove(np.array([1, 1, 2]))
        self.assertEqual(len(simulation), 16)


if __name__ == "__main__":
    unittest.main()
