# SPDX-License-Identifier: MIT
"""Grains in water: joining two simulations, their columns, runs and checkpoints."""

import math
import os
import pathlib
import signal
import tempfile
import threading
import unittest

import numpy as np
from simulations import D, L0, SOFT, balls, bits, discs, grains, pool, tank, water

import silt


def sand(*, joint=None, **further):
    """In 2D."""
    return silt.Coupled(discs(**further), pool(), **({"drag": 20.0} | (joint or {})))


def bits_of_both(both):
    return bits(both.grains), bits(both.fluid)


class Joining(unittest.TestCase):
    def test_makes_parts_of_the_simulations_with_what_was_written(self):
        # The only test of what a simulation keeps when it becomes a part, and of its further fields.
        x = silt.lattice((0.02, 0.02), (0.18, 0.2), 0.4 * D)[::-1]
        sinking, still = discs(position=x, radius=0.16 * D), pool()
        self.assertNotEqual(sinking.ids.tolist(), list(range(len(x))))  # sorted
        column = sinking["spin"]
        sinking["velocity"][3] = (0.1, 0.2)
        sinking["spin"] = np.arange(len(sinking))
        still["velocity"][5] = (0.3, 0)
        before = bits(sinking), bits(still)
        both = silt.Coupled(sinking, still, drag=None)
        self.assertIs(both.grains, sinking)
        self.assertIs(both.fluid, still)
        self.assertEqual(repr(both), f"<silt.Coupled in 2D: {len(sinking)} grains in 150 particles of fluid "
                                     "at step 0, t = 0 s>")
        for old, new in zip(before, bits_of_both(both), strict=True):
            for field, values in old.items():
                self.assertEqual(new[field], values, field)
        self.assertLess({"immersion", "fluid_share", "fluid_velocity"}, set(sinking.fields))
        self.assertIn("fluid_fraction", still.fields)
        displaced = len(sinking) * math.pi * (0.16 * D) ** 2
        lacking = L0**2 * (1 / still["fluid_fraction"] - 1)
        self.assertAlmostEqual(lacking.sum(), displaced, delta=1e-9 * displaced)
        both.step(3)
        self.assertIs(column.simulation, sinking)
        self.assertTrue(np.array_equal(column[:], sinking["spin"][:]))
        self.assertEqual((both.steps, still.steps), (3, 3))
        self.assertAlmostEqual(sinking.time, both.time, delta=1e-12)
        self.assertGreater(sinking.steps, 3)

    def test_makes_room_for_the_volume_of_the_grains(self):
        # The only test of make_room and let_fluid_settle() of Python.
        both = sand(joint={"make_room": True})
        removed = 150 - len(both.fluid)
        self.assertAlmostEqual(removed, len(both.grains) * math.pi * (D / L0) ** 2 / 4, delta=0.51)
        positions = both.grains["position"][:]
        first = both.let_fluid_settle(max_steps=1)
        self.assertLess(both.let_fluid_settle(max_steps=30), first)
        self.assertTrue(np.array_equal(both.grains["position"], positions))
        self.assertEqual(both.time, 0)
        for bad in ({"tolerance": 0}, {"tolerance": math.nan}, {"tolerance": "fine"}, {"max_steps": -1},
                    {"max_steps": 0.5}):
            with self.assertRaises(silt.Error, msg=repr(bad)):
                both.let_fluid_settle(**bad)
        both.step()
        with self.assertRaisesRegex(silt.Error, "before the first one"):
            both.let_fluid_settle()

    def test_refuses_what_does_not_fit_and_changes_nothing(self):
        # The only test of the sentences for simulations that cannot be joined.
        stepped, removed = discs(), discs()
        stepped.step()
        removed.remove(4)
        both = sand()
        cases = {
            "grains = 3 is none": (3, pool(), {}),
            "fluid = None is none": (discs(), None, {}),
            "are the same": (both.grains, both.grains, {}),
            "grains is a simulation of another kind .*grain_simulation": (pool(), pool(), {}),
            "fluid is a simulation of another kind .*flow_simulation": (discs(), discs(), {}),
            "fluid is .* another kind or dimension": (discs(), tank(), {}),
            "is in a Coupled": (both.grains, pool(), {}),
            "grains has made 1 steps": (stepped, pool(), {}),
            "of grains, particles were removed": (removed, pool(), {}),
            "gravity is": (discs(gravity=(0, -1)), pool(), {}),
            "diameter of 0.022": (discs(radius=0.011, position=[(0.1, 0.1)]), pool(), {}),
            "viscosity = 0 m.*drag=None": (balls(), tank(viscosity=0), {"drag": "stokes"}),
            "drag = 'ergun' is a law of spheres": (discs(), pool(), {"drag": "ergun"}),
            "drag = 'laminar'; give 'stokes' or": (discs(), pool(), {"drag": "laminar"}),
            r"drag = \[1\]": (discs(), pool(), {"drag": [1]}),
            "drag = -1": (discs(), pool(), {"drag": -1}),
            "drag = nan": (discs(), pool(), {"drag": math.nan}),
            "Coupled: added_mass = -1": (discs(), pool(), {"added_mass": -1}),
            "Coupled: lift = 1e.300 is outside 0 to 100": (discs(), pool(), {"lift": 1e300}),
            "Coupled: lift = nan": (discs(), pool(), {"lift": math.nan}),
            "lift = 'none' is not a number": (discs(), pool(), {"lift": "none"}),
            "make_room = 1": (discs(), pool(), {"make_room": 1}),
            "closest packing": (discs(position=silt.lattice((0, 0), (0.2, 0.2), 0.25 * D), max_overlap=9),
                                pool(), {}),
            "on a wall of the flow": (discs(position=[(0.2, 0.1)]), pool(), {}),
        }
        for sentence, (of_grains, of_fluid, further) in cases.items():
            simulations = [each for each in (of_grains, of_fluid) if isinstance(each, silt.Simulation)]
            states = [bits(each) for each in simulations]
            with self.assertRaisesRegex(silt.Error, sentence, msg=sentence):
                silt.Coupled(of_grains, of_fluid, **({"drag": 1.0} | further))
            self.assertEqual(states, [bits(each) for each in simulations])
        with self.assertRaises(TypeError):
            silt.Coupled(discs(), pool())
        silt.Coupled(discs(), pool(viscosity=0), drag=None).step()

    def test_refuses_simulations_in_use(self):
        # The only test that an array or an observer keeps a simulation from becoming a part.
        of_grains = discs()
        view = of_grains["position"].view()
        with self.assertRaisesRegex(silt.Error, "position"):
            silt.Coupled(of_grains, pool(), drag=None)
        del view
        with self.assertRaisesRegex(silt.Error, "observer"):
            of_grains.run(0.001, observer=lambda s: silt.Coupled(s, pool(), drag=None))

    def test_leaves_steps_and_checkpoints_to_both(self):
        # The only test of what a part refuses.
        both = sand()
        for part in (both.grains, both.fluid):
            for call in (part.step, part.time_step, lambda s=part: s.run(until=1),
                         lambda s=part: s.write_checkpoint("state"),
                         lambda s=part: s.read_checkpoint("state")):
                with self.assertRaisesRegex(silt.Error, "part of a Coupled; call its"):
                    call()


class Forces(unittest.TestCase):
    def drag_factor(self, drag, **further):
        """Over that of Stokes, of a sphere at Re = 10; and the fluid fraction around it."""
        viscosity, speed = 1e-4, 0.1
        both = silt.Coupled(balls(velocity=(speed, 0, 0), **further), tank(viscosity=viscosity), drag=drag)
        dt = 1e-6
        both.step(time_step=dt)
        impulse = both.grains["exchanged_impulse"][0, 0]
        return -impulse / dt / (3 * math.pi * 1000 * viscosity * D * speed), both.grains["fluid_share"][0]

    def test_of_drag_are_those_of_the_named_law(self):
        # The only test that a name of Python is the law of that name.
        stokes, e = self.drag_factor("stokes")
        self.assertLess(e, 1)
        re = 10 * e
        correction = 1 + 0.15 * re**0.687
        expected = {
            "stokes": 1,
            "schiller_naumann": 1 + 0.15 * 10**0.687,
            "wen_yu": correction * e**-2.65,
            "gidaspow": correction * e**-2.65,
            "ergun": (150 * (1 - e) / e + 1.75 * 10) / 18,
            "di_felice": (0.63 * math.sqrt(re) + 4.8) ** 2 / 24
                         * e ** (1 - 3.7 + 0.65 * math.exp(-((1.5 - math.log10(re)) ** 2) / 2)),
            3 * math.pi * 0.1 * D: 1,
        }
        for drag, factor in expected.items():
            self.assertAlmostEqual(self.drag_factor(drag)[0], factor, delta=0.01 * factor, msg=drag)
        self.assertEqual(self.drag_factor(None)[0], 0)
        self.assertLess(abs(stokes - 1), 0.01)

    def test_of_added_mass_and_lift_are_those_asked_for(self):
        # The only test of these two options of Python: with an added mass, a sphere begins to sink more slowly.
        def speed(**further):
            both = silt.Coupled(balls(), tank(velocity=(0, 0, 0)), drag=None, **further)
            both.let_fluid_settle()
            both.run(until=0.01, end_exactly=True)
            return both.grains.snapshot()["velocity"][0, 2]

        self.assertAlmostEqual(speed(added_mass=0.5) / speed(), 2500 / (2500 + 500), delta=0.02)
        x = silt.lattice((0, 0, 0), (0.1, 0.1, 0.12), L0)
        across = []
        for lift in (0, 0.5):
            shear = np.stack([5 * (x[:, 2] - 0.06), 0 * x[:, 0], 0 * x[:, 0]], axis=1)
            both = silt.Coupled(balls(velocity=(0.2, 0, 0)), tank(velocity=shear), drag=None, lift=lift)
            both.step(time_step=1e-4)
            across.append(both.grains["exchanged_impulse"][0, 2])
        self.assertEqual(across[0], 0)
        # (u − v) × ω, with u − v along −x and ω along y.
        self.assertLess(across[1], 0)

    def test_lose_by_drag_what_the_energies_lack(self):
        # The only test of the energies of both in Python.
        both = sand()
        both.let_fluid_settle()
        both.step()
        before = both.energies()
        both.run(until=0.02)
        after = both.energies()
        kept = ("kinetic_of_grains", "potential_of_grains", "kinetic_of_fluid", "potential_of_fluid")
        self.assertEqual(set(after), {*kept, "lost_by_exchange", "imbalance"})
        self.assertGreater(after["lost_by_exchange"], before["lost_by_exchange"])
        self.assertGreater(sum(before[name] for name in kept), sum(after[name] for name in kept))
        self.assertLess(abs(after["imbalance"]), 1e-10 * abs(after["potential_of_fluid"]))

    def test_of_contacts_are_those_without_water(self):
        # The only test that each contact law has its bits in a Coupled: of grains beside the water.
        linear = silt.LinearSpringDashpot(normal_stiffness=2e3, tangential_stiffness=1e3, restitution=0.7,
                                          friction_angle=0.3)
        elastic = silt.HertzMindlin(young_modulus=1e5, poisson_ratio=0.3, restitution=0.6, friction_angle=0.4)
        for law in (SOFT, linear, elastic):
            x = silt.lattice((0.5, 0.01), (0.58, 0.06), D)
            x[:, 0] += 0.03 * D * np.sin(np.arange(len(x)))
            arguments = {"position": x, "radius": 0.49 * D, "law": law,
                         "walls": [silt.Plane(normal=(0, 1)), silt.Plane(point=(0.579, 0), normal=(-1, 0))]}
            alone, beside = grains(**arguments), grains(**arguments)
            for simulation in (alone, beside):
                simulation.set_wall_present(1, False)
            both = silt.Coupled(beside, water(), drag=20.0)
            for _ in range(4):
                both.step(time_step=2e-3)
                alone.run(until=both.time, end_exactly=True)
            beside.set_wall_present(1, True)
            alone.set_wall_present(1, True)
            both.step(5, time_step=1e-3)
            for _ in range(5):
                alone.run(until=alone.time + 1e-3, end_exactly=True)
            self.assertEqual(beside["immersion"].max(), 0)
            self.assertEqual(beside.steps, alone.steps)
            for field in alone.fields:
                self.assertTrue(np.array_equal(alone[field], beside[field]), field)
            self.assertEqual(alone.energies(), beside.energies())
            self.assertTrue(np.array_equal(alone.wall_load(0)[0], beside.wall_load(0)[0]))
            self.assertGreater(alone.energies()["elastic"], 0)


class Runs(unittest.TestCase):
    def test_have_the_same_bits_on_any_threads_by_steps_and_after_a_restart(self):
        # The only test of the state of both in a checkpoint of Python, and of its threads.
        with tempfile.TemporaryDirectory() as folder:
            for make in (sand, lambda: silt.Coupled(balls(), tank(), drag="di_felice")):
                file = pathlib.Path(folder) / "state"
                one, other, third = make(), make(), make()
                one.run(until=0.01)
                one.write_checkpoint(file)
                self.assertGreaterEqual(one.time, 0.01 * (1 - 1e-9))
                one.run(until=0.03)
                silt.use_threads(3)
                while other.time < 0.03 * (1 - 1e-12):
                    other.step()
                silt.use_threads(1)
                third.read_checkpoint(str(file))
                third.run(until=0.03)
                self.assertEqual(bits_of_both(one), bits_of_both(other))
                self.assertEqual(bits_of_both(one), bits_of_both(third))

    def test_continue_with_the_openings_of_the_water(self):
        # The only test of openings, and of walls that move, in a Coupled.
        def make():
            inflow = silt.Inflow(faces=[[(0.1, 0), (0.1, 0.3)]], velocity=(0.5, 0), level=0.2)
            flow = water(position=silt.lattice((0.1, 0), (0.3, 0.2), L0), velocity=(0.5, 0), openings=inflow)
            of_grains = discs(position=[(0.2, 0.1)], velocity=(0.5, 0))
            return silt.Coupled(of_grains, flow, drag=20.0)

        one, other = make(), make()
        one.run(until=0.1)
        layer = 0.2 * L0
        self.assertAlmostEqual(one.fluid.openings[0].volume, 0.1 * 0.5 * 0.2, delta=1.01 * layer)
        self.assertEqual(len(one.fluid), 100 + one.fluid.openings[0].added)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            one.write_checkpoint(file)
            other.read_checkpoint(file)
        one.step(5)
        other.step(5)
        self.assertEqual(bits_of_both(one), bits_of_both(other))
        self.assertEqual(one.fluid.openings, other.fluid.openings)

    def test_go_on_with_a_body_after_particles_were_removed(self):
        # The only test of measures, a body and removed particles in a Coupled.
        box = silt.faces_of_box((0.3, 0.15), (0.5, 0.25))
        x = silt.remove_inside(silt.lattice((0, 0), (0.6, 0.2), L0), box, L0)
        flow = water(position=x, bodies=silt.FloatingBody(faces=box, density=500))
        both = silt.Coupled(discs(position=silt.lattice((0.02, 0.05), (0.1, 0.1), 1.6 * D)), flow, drag=20.0)
        both.run(until=0.05)
        self.assertAlmostEqual(flow.body_load(0)[0][1], 500 * 0.2 * 0.1 * 9.81, delta=10)
        self.assertAlmostEqual(flow.bodies[0].position[1], 0.2, delta=0.01)
        self.assertAlmostEqual(flow.wall_pressure((0, 0.05), (1, 0)), 1000 * 9.81 * 0.15, delta=200)
        self.assertGreater(flow.energies()["kinetic"], 0)
        left = both.grains.ids[3:]
        both.grains.remove(both.grains.ids[:3])
        flow.remove(flow.ids[:2])
        both.step(3)
        self.assertEqual(sorted(both.grains.ids), sorted(left))
        self.assertEqual(len(flow), len(x) - 2)

    def test_of_other_arguments_are_refused_by_name(self):
        # The only test of what a checkpoint of a Coupled is compared with.
        box = silt.Box(lower=(-1, -1), upper=(1, 1))
        cases = {
            "another drag;": {"joint": {"drag": 21.0}},
            "another drag; ": {"joint": {"drag": None}},
            "another added_mass;": {"joint": {"added_mass": 1}},
            "another lift;": {"joint": {"lift": 0.5}},
            "damping = 0, but here it is 0.5": {"damping": 0.5},
            "box: lower = (-inf, -inf), but here it is (-1, -1)": {"box": box},
        }
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            written = sand()
            written.step(2)
            written.write_checkpoint(file)
            for sentence, further in cases.items():
                other = sand(**further)
                before = bits_of_both(other)
                with self.assertRaisesRegex(silt.Error, "accepts_other_setup=True$") as caught:
                    other.read_checkpoint(file)
                self.assertIn("was written with " + sentence, caught.exception.what)
                self.assertEqual((bits_of_both(other), other.time), (before, 0))
                other.read_checkpoint(file, accepts_other_setup=True)
                self.assertEqual(other.time, written.time)
                other.step()
            for other in (discs(), pool(), silt.Coupled(balls(), tank(), drag=None)):
                with self.assertRaises(silt.Error):
                    other.read_checkpoint(file)

    def test_call_observers_with_both(self):
        # The only test of observers of a Coupled, and of what they write.
        both, seen = sand(), []

        def observe(each):
            seen.append((each, each.time, each.grains["position"][:, 1].mean()))
            each.grains["velocity"] += (0.01, 0)

        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            files = [silt.VtkSeries(folder / "both"), silt.VtkWalls(folder / "walls")]
            both.run(until=0.02, output_every=0.01, observer=[observe, *files])
            names = {path.name for path in folder.rglob("*.vtu")}
        self.assertLess({"both_grains_000002.vtu", "both_fluid_000002.vtu", "walls_000002.vtu"}, names)
        self.assertTrue(all(each is both for each, _, _ in seen))
        self.assertEqual(len(seen), 3)
        self.assertNotEqual(seen[2][2], seen[0][2])
        with self.assertRaisesRegex(silt.Error, "Coupled.step: an observer"):
            both.run(until=0.03, observer=lambda each: each.step())

    def test_are_not_made_while_arrays_refer_to_a_part(self):
        # The only test that both and their parts know of each other's arrays and threads.
        both = sand()
        for part in (both.grains, both.fluid):
            view = part["position"].view(writable=True)
            with self.assertRaisesRegex(silt.Error, 'Coupled.step: an array still refers to .*"position"'):
                both.step()
            view[0, 0] += 1e-6
            del view
            both.step()
        running, goes_on = threading.Event(), threading.Event()

        def observe(_):
            running.set()
            goes_on.wait()

        thread = threading.Thread(target=both.run, args=(both.time + 1e-3,), kwargs={"observer": observe})
        thread.start()
        running.wait()
        for call in (both.step, lambda: both.time, lambda: both.grains["position"], both.fluid.snapshot):
            with self.assertRaisesRegex(silt.Error, "another thread"):
                call()
        goes_on.set()
        thread.join()

    def test_that_fail_change_neither(self):
        # The only test that a step of a Coupled in Python is undone in both.
        both, undisturbed = sand(), sand()
        both.step(3)
        before = bits(both.grains), both.time
        with self.assertRaisesRegex(silt.Error, "more than the spacing"):
            both.step(time_step=0.2)
        self.assertEqual((bits(both.grains), both.time, both.steps), (*before, 3))
        velocity = both.grains["velocity"][2]
        both.grains["velocity"][2] = math.nan
        with self.assertRaisesRegex(silt.Error, "velocity") as caught:
            both.step()
        self.assertEqual((caught.exception.id, both.steps), (2, 3))
        both.grains["velocity"][2] = velocity
        both.step()
        undisturbed.step(4)
        self.assertEqual(bits_of_both(both), bits_of_both(undisturbed))

    def test_end_by_an_interrupt_between_two_steps(self):
        # The only test of Ctrl-C in a run of both.
        both = sand()
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            both.run(until=1e3)
        timer.join()
        both.step()


if __name__ == "__main__":
    unittest.main()
