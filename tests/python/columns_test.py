# SPDX-License-Identifier: MIT
"""Columns and arrays of the memory of a simulation: they show the present step, or no step is made."""

import gc
import pathlib
import tempfile
import unittest
import weakref

import numpy as np
from simulations import R, bits, grains, spheres, water

import silt


class Columns(unittest.TestCase):
    def test_show_the_values_that_were_given(self):
        x = silt.lattice((-0.08, 0.1), (0.08, 0.3), 2 * R)
        simulation = grains(velocity=x)
        np.testing.assert_array_equal(simulation["position"], x)
        np.testing.assert_array_equal(simulation["velocity"], x)
        np.testing.assert_array_equal(simulation["radius"], R)
        self.assertEqual(simulation["position"].shape, (20, 2))
        self.assertEqual(simulation["mass"].shape, (20,))
        self.assertEqual(len(simulation["spin"]), 20)
        self.assertEqual(simulation["material"].dtype, np.uint32)
        np.testing.assert_array_equal(simulation.ids, np.arange(20))

    def test_have_all_fields_of_any_particles(self):
        of_grains = {"position", "velocity", "spin", "force", "torque", "mass", "inertia", "radius", "material"}
        self.assertEqual(set(grains().fields), of_grains | {"angle"})
        self.assertEqual(set(spheres().fields), of_grains)
        self.assertEqual(set(water().fields),
                         {"position", "velocity", "pressure", "kind", "number_density", "surface"})
        for simulation in (grains(), spheres(), water()):
            for field in simulation.fields:
                self.assertEqual(len(simulation[field].view()), len(simulation))
        self.assertEqual(spheres()["spin"].shape, (27, 3))

    def test_are_renewed_by_steps(self):
        for simulation in (grains(), water()):
            column = simulation["position"]
            before = column[:]
            simulation.step(3)
            self.assertFalse(np.array_equal(column, before))
            np.testing.assert_array_equal(column, simulation["position"])
            np.testing.assert_array_equal(column, column.view())

    def test_are_renewed_when_particles_are_removed_or_sorted(self):
        simulation = grains(position=silt.lattice((-0.08, 0.1), (0.08, 0.3), 2 * R)[::-1])
        column = simulation["position"]
        by_id = dict(zip(simulation.ids, column[:], strict=True))
        simulation.remove([3, 17])
        self.assertEqual(len(column), 18)
        for i, x in zip(simulation.ids, column, strict=True):
            np.testing.assert_array_equal(x, by_id[i])
        simulation.step(2000)
        np.testing.assert_array_equal(column[:][np.argsort(simulation.ids)], simulation.snapshot()["position"])

    def test_are_renewed_when_particles_leave_the_box(self):
        simulation = grains(walls=[], box=silt.Box(lower=(-1, 0.1), upper=(1, 1), on_escape="remove"))
        column = simulation["radius"]
        simulation.run(until=0.1)
        self.assertLess(len(column), 20)
        self.assertEqual(len(column), len(simulation))
        self.assertEqual(simulation.particles_lost, 20 - len(simulation))

    def test_are_read_as_copies(self):
        simulation = grains()
        rows = simulation["position"][2:5]
        array = np.asarray(simulation["position"])
        rows[:] = 7
        array[:] = 7
        self.assertFalse((simulation["position"][:] == 7).any())
        self.assertIsInstance(simulation["mass"][0], np.float64)

    def test_are_written_to(self):
        simulation = grains()
        velocity = simulation["velocity"]
        velocity[:, 0] = 1
        velocity[3] = (5, 6)
        velocity += [0, 1]
        simulation["velocity"] *= 2
        simulation["velocity"][4:6] -= 1
        expected = np.tile([2.0, 2.0], (20, 1))
        expected[3] = 10, 14
        expected[4:6] -= 1
        np.testing.assert_array_equal(simulation["velocity"], expected)
        simulation["velocity"] = expected[::-1]
        np.testing.assert_array_equal(simulation["velocity"], expected[::-1])
        np.add(velocity, 1, out=velocity)
        np.testing.assert_array_equal(velocity[:], expected[::-1] + 1)
        simulation["velocity"] = simulation["position"]
        np.testing.assert_array_equal(velocity[:], simulation["position"][:])

    def test_take_part_in_expressions(self):
        simulation = grains(velocity=(3, 4))
        m, v = simulation["mass"], simulation["velocity"]
        speed = np.sqrt((v * v).sum(axis=1))
        np.testing.assert_array_equal(speed, 5)
        np.testing.assert_array_equal(np.linalg.norm(v, axis=1), 5)
        self.assertAlmostEqual((m * speed**2 / 2).sum() / simulation.energies()["kinetic"], 1)
        self.assertTrue((v == v[:]).all())
        self.assertIn("velocity", repr(v))
        self.assertEqual(np.add.reduce(m), np.sum(m[:]))

    def test_have_the_functions_of_arrays(self):
        simulation = grains()
        column = simulation["velocity"]
        column[:] = np.arange(column.size).reshape(column.shape)
        values = column[:]
        for name in ("all", "any", "max", "mean", "min", "std", "sum", "tolist", "copy", "flatten"):
            self.assertTrue(np.array_equal(getattr(column, name)(), getattr(values, name)()), name)
        self.assertEqual(column.T.shape, values.T.shape)
        self.assertEqual(column.max(axis=0).tolist(), values.max(axis=0).tolist())
        column.T[:] = -1  # a copy
        self.assertTrue(np.array_equal(column, values))
        with self.assertRaises(ValueError):
            bool(column)
        with self.assertRaisesRegex(AttributeError, "sort.*view"):
            column.sort()
        simulation.step()

    def test_are_written_to_at_repeated_rows(self):
        for field, value in (("velocity", (0.5, 0.25)), ("radius", 1e-4)):
            one, other = grains(), grains()
            energy = one.energies()["kinetic"]
            np.add.at(one[field], [3, 3, 5], value)
            for row in (3, 3, 5):
                other[field][row] += value
            self.assertEqual(bits(one), bits(other))
            if field == "velocity":
                self.assertGreater(one.energies()["kinetic"], energy)
            one.step(20)
            other.step(20)
            self.assertEqual(bits(one), bits(other))

    def test_of_unknown_fields_are_refused(self):
        for name in ("temperature", "", 0, None, ("position",), slice(None)):
            with self.assertRaisesRegex(silt.Error, "position"):
                grains()[name]
        self.assertNotIn("temperature", grains())
        self.assertIn("radius", grains())

    def test_refuse_values_that_do_not_fit(self):
        simulation = grains()
        before = bits(simulation)
        for value in (np.zeros((20, 3)), np.zeros(20), "fast", 1j, [[1, 2]] * 19, None, [object()], {}):
            with self.assertRaises(silt.Error, msg=repr(value)):
                simulation["velocity"] = value
        with self.assertRaises(silt.Error):
            simulation["material"][0] = 0.5
        with self.assertRaises(silt.Error):
            simulation["material"][0] = -1
        simulation["material"] = np.zeros(20, dtype=int)
        with self.assertRaises(IndexError):
            simulation["velocity"][20]
        with self.assertRaises(IndexError):
            simulation["velocity"][20] = 0
        self.assertEqual(bits(simulation), before)

    def test_that_failed_do_not_keep_steps_from_being_made(self):
        simulation = grains()
        kept = []
        for fails in (lambda: simulation["velocity"] + "fast", lambda: simulation["velocity"][99],
                      lambda: simulation["velocity"].__setitem__(slice(None), "fast"),
                      lambda: simulation["velocity"].__setitem__(99, 0),
                      lambda: np.add(simulation["velocity"], 1, out=simulation["mass"])):
            try:
                fails()
            except Exception as error:  # noqa: BLE001
                kept.append(error)
        self.assertEqual(len(kept), 5)
        simulation.step()


class Views(unittest.TestCase):
    def test_are_the_memory_of_the_simulation(self):
        for simulation in (grains(), spheres(), water()):
            for field in ("position", "velocity"):
                a = simulation[field].view()
                b = simulation[field].view(writable=True)
                self.assertFalse(a.flags.owndata)
                self.assertTrue(np.shares_memory(a, b))
                b[2, 1] = 0.125
                self.assertEqual(a[2, 1], 0.125)
                self.assertEqual(simulation[field][2, 1], 0.125)
                del a, b

    def test_move_grains(self):
        one, other = grains(), grains()
        x = one["position"].view(writable=True)
        x[:, 1] += 0.25
        del x
        other["position"] = other["position"] + [0, 0.25]
        for simulation in (one, other):
            simulation.run(until=0.05)
        self.assertEqual(bits(one), bits(other))

    def test_refuse_steps_while_they_are_used(self):
        for simulation in (grains(), water()):
            view = simulation["velocity"].view()
            part = view[3:, 1]
            calls = [simulation.step, lambda s=simulation: s.run(until=1), lambda s=simulation: s.remove(1)]
            before = part.copy()
            for call in calls:
                with self.assertRaisesRegex(silt.Error, "velocity.* step 0"):
                    call()
            del view
            with self.assertRaisesRegex(silt.Error, "copy"):
                simulation.step()
            self.assertEqual(simulation.steps, 0)
            np.testing.assert_array_equal(part, before)
            del part
            simulation.step()
            self.assertEqual(simulation.steps, 1)

    def test_refuse_steps_through_any_reference(self):
        simulation = grains()
        makers = [memoryview, iter, np.transpose, np.frombuffer, lambda v: v.reshape(-1)[::2],
                  lambda v: v.view(np.uint8), lambda v: np.lib.stride_tricks.as_strided(v, (2, 2)),
                  lambda v: {"deep": [v[3]]}]
        for make in makers:
            kept = make(simulation["force"].view())
            with self.assertRaises(silt.Error):
                simulation.step()
            del kept
            simulation.step()

    def test_refuse_reading_of_a_checkpoint(self):
        simulation = grains()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state.silt"
            simulation.write_checkpoint(file)
            view = simulation["mass"].view()
            with self.assertRaises(silt.Error):
                simulation.read_checkpoint(file)
            del view
            simulation.read_checkpoint(file)

    def test_cannot_be_written_to_unless_that_was_asked_for(self):
        view = grains()["position"].view()
        with self.assertRaises(ValueError):
            view[0] = 0
        with self.assertRaises(ValueError):
            view.flags.writeable = True

    def test_that_write_are_noticed_whenever_they_do(self):
        # The radius sets the reach of the contacts, which the simulation caches; so do positions.
        one, other = grains(), grains()
        radius = one["radius"].view(writable=True)
        position = one["position"].view(writable=True)
        one.time_step(), one.energies()
        radius *= 0.5
        position[:, 1] -= 0.09
        self.assertAlmostEqual(one.energies()["potential"], one["mass"][:] @ one["position"][:, 1] * 9.81)
        del radius, position
        other["radius"] = R / 2
        other["position"][:, 1] -= 0.09
        for simulation in (one, other):
            simulation.run(until=0.05)
        self.assertEqual(bits(one), bits(other))

    def test_in_the_middle_of_a_run_are_noticed(self):
        one, other = grains(), grains()
        for simulation in (one, other):
            simulation.run(until=0.1)
        one["radius"].view(writable=True)[:] *= 1.001
        np.multiply(other["radius"], 1.001, out=other["radius"])
        for simulation in (one, other):
            simulation.run(until=0.2)
        self.assertEqual(bits(one), bits(other))

    def test_that_only_read_change_no_bit(self):
        one, other = grains(), grains()
        for _ in range(50):
            one.step(20)
            other.step(20)
            for field in one.fields:
                one[field].view().sum()
            one.energies(), one.snapshot(), one.wall_load(0)
        self.assertEqual(bits(one), bits(other))

    def test_outlive_the_name_of_the_simulation(self):
        simulation = grains()
        alive = weakref.ref(simulation)
        view = simulation["position"].view()
        expected = view.copy()
        column = simulation["position"]
        del simulation
        gc.collect()
        np.testing.assert_array_equal(view, expected)
        np.testing.assert_array_equal(column, expected)
        self.assertIsNotNone(alive())
        del column
        gc.collect()
        self.assertIsNone(alive())
        np.testing.assert_array_equal(view, expected)  # of the memory, which it keeps
        del view

    def test_of_no_particles_are_empty(self):
        simulation = grains(position=np.zeros((0, 2)))
        self.assertEqual(simulation["position"].view().shape, (0, 2))
        self.assertEqual(simulation["mass"][:].shape, (0,))
        self.assertEqual(simulation.snapshot()["id"].shape, (0,))
        simulation = grains()
        simulation.remove(simulation.ids)
        self.assertEqual(simulation["position"].view().shape, (0, 2))
        self.assertEqual(simulation.energies()["kinetic"], 0)

    def test_release_simulations(self):
        alive = []
        for _ in range(20):
            simulation = grains()
            alive.append(weakref.ref(simulation))
            simulation.run(until=0.01, output_every=0.005, observer=lambda s: s["position"].view().sum())
        del simulation
        gc.collect()
        self.assertEqual([each() for each in alive], [None] * 20)


if __name__ == "__main__":
    unittest.main()
