# SPDX-License-Identifier: MIT
# Proves that motions, moving walls and floating bodies of Python are those of C++, and that functions of Python are
# called by steps as safely as observers are.
"""Moving walls and floating bodies of flows; functions of Python that steps call."""

import math
import pathlib
import subprocess
import sys
import tempfile
import threading
import traceback
import unittest

import numpy as np
from simulations import bits, floating_box, grains, paddle, water

import silt

NAN = math.nan


class Own(Exception):
    pass


class Motions(unittest.TestCase):
    def test_as_functions_have_the_bits_of_those_of_the_library(self):
        omega = 2 * math.pi * 2
        table = {"times": (0, 0.5, 1), "shifts": [(0, 0), (0.05, 0), (0.1, 0)]}
        for motion, function in (
                (silt.Vibration(amplitude=(0.02, 0), frequency=2), lambda t: ((0.02 * math.sin(omega * t), 0), 0)),
                (silt.Translation(velocity=(0.1, 0)), lambda t: (np.array([0.1 * t, 0]), np.zeros(1)))):
            one, other = paddle(motion), paddle(function)
            for simulation in (one, other):
                simulation.step(10, time_step=1e-3)
            self.assertEqual(bits(one), bits(other))
        still = paddle(silt.Translation(velocity=(0, 0)))
        moved = paddle(silt.TabulatedMotion(**table))
        for simulation in (still, moved):
            simulation.run(until=0.15)
        self.assertGreater(moved["position"][:, 0].min(), 0.005 + still["position"][:, 0].min())

    def test_turn_about_their_point(self):
        board = [[(0.3, 0.05), (0.3, 0.25)]]  # between columns of particles
        spin, about = 0.5, (0.3, 0.15)
        results = []
        for motion in (silt.Rotation(spin=spin, about=about),
                       silt.MotionFunction(function=lambda t: ((0, 0), spin * t), about=about),
                       silt.TabulatedMotion(times=(-1, 0, 1, 2), turns=(-spin, 0, spin, 2 * spin), about=about)):
            stirred = water(position=silt.lattice((0, 0), (0.6, 0.3), 0.02),
                            moving=silt.MovingFaces(faces=board, motion=motion))
            stirred.step(10, time_step=1e-3)
            results.append(stirred["velocity"][:])
        self.assertGreater(np.abs(results[0]).max(), 0.01)
        for result in results[1:]:
            np.testing.assert_allclose(result, results[0], atol=1e-6)

    def test_that_raise_end_the_run_as_before_the_step(self):
        def fails(t):
            if t > 0.02:
                raise Own("mine", 3)
            return (0.1 * t, 0), 0

        simulation, undisturbed = paddle(fails), paddle(lambda t: ((0.1 * t, 0), 0))
        try:
            simulation.run(until=1, time_step=1e-3)
            self.fail("nothing was raised")
        except Own as error:
            self.assertEqual(error.args, ("mine", 3))
            self.assertIn("fails", [frame.name for frame in traceback.extract_tb(error.__traceback__)])
        self.assertGreater(simulation.steps, 10)
        undisturbed.step(simulation.steps, time_step=1e-3)
        self.assertEqual(bits(simulation), bits(undisturbed))
        with self.assertRaises(Own):
            simulation.step(time_step=1e-3)
        with self.assertRaises(Own):
            paddle(lambda _: fails(1))

    def test_that_return_anything_else_are_refused(self):
        for value in (None, 0, (0, 0), ((0, 0, 0), 0), ((0, 0), (0, 0, 0)), ((0, NAN), 0), ("aside", 0), ((0, 0), "up"),
                      ((0, 0), 0, 0), ((1, 0), 0)):
            with self.assertRaises(silt.Error, msg=repr(value)):
                # A jump, to the last one.
                paddle(lambda t, value=value: value if t > 0.01 else ((0, 0), 0)).run(until=0.02)

    def test_must_not_use_the_simulation(self):
        simulations = []

        def curious(t):
            if simulations and t > 0.005:
                simulations[0]["position"].max()
            return (0, 0), 0

        simulations.append(paddle(curious))
        with self.assertRaisesRegex(silt.Error, "must not use the simulation"):
            simulations[0].run(until=0.1)

    def test_run_beside_other_threads_and_within_observers(self):
        simulation, seen = paddle(lambda t: ((0.1 * t, 0), 0)), []

        def observe(s):
            seen.append((s.time_step(), s.wall_load(0)))

        threads = [threading.Thread(target=paddle(lambda t: ((0.1 * t, 0), 0)).run, args=(0.03,)) for _ in range(2)]
        for thread in threads:
            thread.start()
        simulation.run(until=0.03, output_every=0.01, observer=observe)
        for thread in threads:
            thread.join()
        self.assertEqual(len(seen), 4)

    def test_are_no_crash_at_the_end_of_the_interpreter(self):
        program = (
            "import sys, threading\n"
            f"sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})\n"
            "from simulations import paddle\n"
            "begun = threading.Semaphore(0)\n"
            "def motion(t):\n"
            "    begun.release()\n"
            "    for _ in range(1000):\n"
            "        shift = (0.01 * t, 0)\n"
            "    return shift, 0\n"
            "for _ in range(2):\n"
            "    threading.Thread(target=paddle(motion).run, args=(1e4,), daemon=True).start()\n"
            "for _ in range(100):\n"
            "    begun.acquire()\n"
            "sys.exit(5)\n")
        for _ in range(3):
            ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
            self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (5, "", ""))


class MovingWalls(unittest.TestCase):
    def test_have_the_load_of_water_at_rest(self):
        still = paddle(silt.Translation(velocity=(0, 0)))
        self.assertEqual(still.wall_load(0)[0].tolist(), [0, 0])
        forces = []
        still.run(until=0.4, output_every=0.01, observer=lambda s: forces.append(s.wall_load(0)[0]))
        force = np.mean(forces[20:], axis=0)
        weight = 1000 * 9.81 * 0.2**2 / 2
        self.assertAlmostEqual(force[0], -weight, delta=0.05 * weight)
        with self.assertRaisesRegex(silt.Error, "no moving wall 1"):
            still.wall_load(1)

    def test_are_written_where_they_are(self):
        with tempfile.TemporaryDirectory() as folder:
            frames = silt.VtkWalls(pathlib.Path(folder) / "walls")
            paddle(silt.Translation(velocity=(0.1, 0))).run(0.02, 0.01, frames)
            self.assertEqual(frames.frames, 3)
            self.assertEqual(len(list(pathlib.Path(folder).glob("walls/*.vtu"))), 3)
            with self.assertRaisesRegex(silt.Error, "only flows"):
                grains().run(0.01, observer=frames)

    def test_refuse_bad_arguments(self):
        board = [[(0.1, 0.4), (0.1, 0)]]
        still = silt.Translation(velocity=(0, 0))
        for make in (lambda: silt.MovingFaces(faces=board, motion=None),
                     lambda: silt.MovingFaces(faces=board, motion=3),
                     lambda: silt.MovingFaces(faces=board, motion=silt.Translation),
                     lambda: silt.MovingFaces(faces=board[0], motion=still),
                     lambda: silt.MovingFaces(faces="here", motion=still),
                     lambda: water(moving=silt.MovingFaces(faces=np.zeros((0, 2, 2)), motion=still)),
                     lambda: water(moving=silt.MovingFaces(faces=np.zeros((1, 3, 3)), motion=still)),
                     lambda: water(moving=silt.MovingFaces(faces=[[(0, 0), (0, 0)]], motion=still)),
                     lambda: water(moving=[board]), lambda: water(moving=still), lambda: water(walls=board[0]),
                     lambda: water(walls=np.zeros((1, 3, 3))), lambda: water(bodies=[3]),
                     lambda: paddle(silt.Translation(velocity=(0, 0, 0))),
                     lambda: paddle(silt.Translation(velocity=(NAN, 0))), lambda: silt.Translation(velocity=1),
                     lambda: paddle(silt.Rotation(spin=(0, 0, 1))), lambda: silt.Rotation(spin=(0, 1)),
                     lambda: paddle(silt.Vibration(amplitude=(0.1, 0), frequency=-1)),
                     lambda: silt.Vibration(amplitude=(0.1, 0), frequency="fast"),
                     lambda: paddle(silt.TabulatedMotion(times=[0])),
                     lambda: paddle(silt.TabulatedMotion(times=[0, 0])),
                     lambda: paddle(silt.TabulatedMotion(times=[0, 1], shifts=[(0, 0)])),
                     lambda: paddle(silt.TabulatedMotion(times=[0, 1], shifts=np.zeros((2, 3)))),
                     lambda: paddle(silt.TabulatedMotion(times=[0, 1], turns=np.zeros((2, 3)))),
                     lambda: silt.TabulatedMotion(times=[[0]]), lambda: silt.MotionFunction(function=0),
                     lambda: silt.faces_of_box((0, 0), (1, 1, 1)), lambda: silt.faces_of_polyline([(0, 0)]),
                     lambda: silt.faces_of_polyline(np.zeros((3, 3))),
                     lambda: silt.faces_of_disc((0, 0, 0), 1, 1), lambda: silt.faces_of_sphere((0, 0, 0), -1, 1),
                     lambda: silt.faces_of_disc((0, 0), 1, 1e-9),
                     lambda: silt.remove_inside(np.zeros((1, 2)), np.zeros((1, 3, 3)), 0.1),
                     lambda: silt.remove_inside(np.zeros((1, 2)), board, 0)):
            with self.assertRaises(silt.Error) as caught:
                make()
            self.assertRegex(str(caught.exception), r"[a-z]+.*[;:]", "names the quantity, and what to do")


class Bodies(unittest.TestCase):
    def test_float_with_the_load_of_their_weight(self):
        simulation = floating_box()
        (before,) = simulation.bodies
        np.testing.assert_allclose(before.position, (0.3, 0.2))
        self.assertEqual((before.orientation, before.spin, before.velocity.tolist()), (0, 0, [0, 0]))
        loads = []
        simulation.run(until=0.5, output_every=0.01, observer=lambda s: loads.append(s.body_load(0)[0]))
        weight = 500 * 9.81 * 0.2 * 0.1
        self.assertAlmostEqual(np.mean(loads[10:], axis=0)[1], weight, delta=0.05 * weight)
        (after,) = simulation.bodies
        np.testing.assert_allclose(after.position, (0.3, 0.2), atol=0.01)
        np.testing.assert_allclose(after.rotation @ before.position + after.shift, after.position, atol=1e-12)

    def test_are_pushed_by_the_load_of_the_user_and_held(self):
        seen = []

        def spring(state, time):
            seen.append((state, time))
            return (-100 * (state.position[0] - 0.25), 0), 0

        pulled = floating_box(load=spring, keeps_orientation=True)
        pulled.run(until=0.1)
        self.assertLess(pulled.bodies[0].position[0], 0.3 - 1e-3)
        self.assertLess(pulled.bodies[0].velocity[0], 0)
        self.assertEqual(pulled.bodies[0].orientation, 0)
        self.assertIsInstance(seen[0][0], silt.BodyState)
        self.assertEqual(seen[0][1], 0)
        held = floating_box(load=spring, held=(True, False), velocity=(0.05, 0))
        held.run(until=0.1, end_exactly=True)
        self.assertAlmostEqual(held.bodies[0].position[0], 0.3 + 0.05 * 0.1, delta=1e-9)

        def fails(_, time):
            if time > 0.02:
                raise Own
            return (0, 0), 0

        with self.assertRaises(Own):
            floating_box(load=fails).run(until=0.1)
        for value in (None, ((0, 0), (0, 0, 0)), ((0, NAN), 0), (0, 0)):
            with self.assertRaises(silt.Error, msg=repr(value)):
                floating_box(load=lambda *_, value=value: value).step()

    def test_continue_from_checkpoints_with_the_same_bits_on_any_number_of_threads(self):
        def make(**further):
            return floating_box(load=lambda state, time: ((math.sin(time), -state.velocity[1]), 0), **further)

        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            one, other = make(), make()
            one.run(until=0.03)
            one.write_checkpoint(file)
            one.run(until=0.06)
            other.read_checkpoint(file)
            silt.use_threads(2)
            other.run(until=0.06)
            silt.use_threads(1)
            self.assertEqual(bits(one), bits(other))
            for a, b in zip(vars(one.bodies[0]).values(), vars(other.bodies[0]).values(), strict=True):
                self.assertTrue(np.array_equal(a, b))
            for different in (make(density=600), make(held=(True, True)), floating_box(), water()):
                with self.assertRaisesRegex(silt.Error, "another tank, lid, wall, motion, opening or body"):
                    different.read_checkpoint(file)

    def test_turn_in_3d(self):
        faces = silt.faces_of_box((0.12, 0.06, 0.1), (0.24, 0.14, 0.2))
        x = silt.remove_inside(silt.lattice((0, 0, 0), (0.36, 0.2, 0.16), 0.02), faces, 0.02)
        self.assertLess(len(x), 18 * 10 * 8)
        inertia = np.diag([0.5, 0.6, 0.7]) * 1e-3
        for properties in ({"density": 500}, {"mass_properties": silt.MassProperties(
                mass=0.48, centre=(0.18, 0.1, 0.15), inertia=inertia)}):
            simulation = silt.flow_simulation(
                position=x, spacing=0.02, tank=(0.36, 0.2, 0.4), speed_scale=1,
                bodies=silt.FloatingBody(faces=faces, spin=(0, 0, 1), velocity=(0, 0, 0.1), **properties))
            simulation.step(3)
            (state,) = simulation.bodies
            self.assertEqual((state.orientation.shape, state.spin.shape), ((4,), (3,)))
            self.assertAlmostEqual(np.linalg.norm(state.orientation), 1)
            self.assertGreater(state.orientation[3], 0)
            self.assertGreater(state.rotation[1, 0], 0)
            self.assertGreater(state.position[2], 0.15)
            self.assertEqual(simulation.body_load(0)[1].shape, (3,))

    def test_meet_as_spheres(self):
        """A sphere that falls on the floor comes to rest a spacing above it, whatever its faces are."""
        faces = silt.faces_of_sphere((0.3, 0.3, 0.15), 0.1, 0.08)
        self.assertEqual(faces.shape[1:], (3, 3))
        simulation = silt.flow_simulation(
            position=[(0.58, 0.58, 0.01)], spacing=0.02, tank=(0.6, 0.6, 0.4), speed_scale=1,
            bodies=silt.FloatingBody(faces=faces, density=3000, radius=0.1, velocity=(0, 0, -0.5)))
        simulation.run(until=0.15)
        self.assertAlmostEqual(simulation.bodies[0].position[2], 0.12, places=6)

    def test_refuse_bad_arguments(self):
        for bad in ({"density": -1}, {"density": 0}, {"density": None}, {"density": "light"}, {"velocity": (0, NAN)},
                    {"velocity": (0, 0, 0)}, {"spin": NAN}, {"spin": (0, 0, 1)}, {"held": (True, False, True)},
                    {"held": "x"}, {"keeps_orientation": 1}, {"keeps_orientation": True, "spin": 1}, {"load": 3},
                    {"radius": -1}, {"radius": 0.3},
                    {"mass_properties": silt.MassProperties(mass=1, centre=(0, 0), inertia=1)},
                    {"density": None, "mass_properties": 3},
                    {"density": None, "mass_properties": silt.MassProperties(mass=-1, centre=(0, 0), inertia=1)},
                    {"density": None, "mass_properties": silt.MassProperties(mass=1, centre=(0, 0), inertia=-1)},
                    {"density": None, "mass_properties": silt.MassProperties(mass=1, centre=(0, 0), inertia=np.eye(3))},
                    {"faces": [[(0.2, 0.1), (0.4, 0.1)]]}, {"faces": np.zeros((4, 3, 3))}, {"faces": np.zeros((4, 2))}):
            with self.assertRaises(silt.Error, msg=repr(bad)) as caught:
                floating_box(**bad)
            self.assertRegex(str(caught.exception), r"[a-z]+.*[;:]", "names the quantity, and what to do")
        for call in (lambda: floating_box().body_load(1), lambda: water().body_load(0), lambda: grains().bodies,
                     lambda: grains().body_load(0), lambda: floating_box().wall_load(0)):
            with self.assertRaises(silt.Error):
                call()
        self.assertEqual(water().bodies, ())


class Fillings(unittest.TestCase):
    def test_are_at_rest_between_any_walls(self):
        tank = {"spacing": 0.02, "tank": (0.6, 0.5)}
        full = silt.fill(inside=(0.1, 0.1), level=0.2, **tank)
        self.assertTrue(np.array_equal(full.position, silt.lattice((0, 0), (0.6, 0.2), 0.02)))
        self.assertEqual((len(full), full.deviation), (300, 0))
        self.assertAlmostEqual(full.volume, 0.12)
        tank["walls"] = silt.faces_of_polyline([(0, 0.4), (0.3, 0.1), (0.6, 0.4)])
        oblique = silt.fill(inside=(0.3, 0.2), level=0.3, **tank)
        self.assertAlmostEqual(oblique.volume, 0.04)
        self.assertLess(oblique.deviation, 1e-6)
        still = silt.flow_simulation(position=oblique.position, speed_scale=1.7, **tank)
        still.run(until=0.1)
        self.assertLess(np.abs(still["velocity"]).max(), 1e-5)

    def test_are_beside_moving_walls_and_bodies(self):
        box, board = silt.faces_of_box((0.24, 0.15), (0.44, 0.25)), [[(0.1, 0.5), (0.1, 0)]]
        around = silt.fill(inside=(0.2, 0.05), level=0.2, spacing=0.02, tank=(0.6, 0.5),
                           moving=silt.MovingFaces(faces=board, motion=lambda t: ((0.1 * t, 0), 0)),
                           bodies=silt.FloatingBody(faces=box, density=500))
        self.assertAlmostEqual(around.volume, 0.5 * 0.2 - 0.2 * 0.05, delta=1e-3)
        self.assertGreater(around.position[:, 0].min(), 0.1)

    def test_are_of_3d(self):
        full = silt.fill(inside=(0.1, 0.1, 0.1), level=0.2, spacing=0.05, tank=(0.5, 0.3, 0.5))
        self.assertTrue(np.array_equal(full.position, silt.lattice((0, 0, 0), (0.5, 0.3, 0.2), 0.05)))

    def test_refuse_bad_arguments(self):
        good = {"inside": (0.1, 0.1), "level": 0.2, "spacing": 0.02, "tank": (0.6, 0.5)}
        for bad in ({"inside": (0.1, 0.1, 0.1)}, {"inside": (2, 2)}, {"inside": 1}, {"level": NAN}, {"level": "high"},
                    {"level": 0.6}, {"spacing": 0}, {"tank": (0.6,)}, {"tank": (0.6, 0)}, {"lid": 1}, {"moving": 3},
                    {"bodies": [3]}, {"walls": np.zeros((1, 3, 3))}, {"walls": [[(0, 0), (0, 0)]]},
                    {"walls": [[(0.095, 0), (0.095, 0.5)], [(0.105, 0), (0.105, 0.5)]]}):
            with self.assertRaises(silt.Error, msg=repr(bad)) as caught:
                silt.fill(**(good | bad))
            self.assertRegex(str(caught.exception), r"[a-z]+.*[;:]", "names the quantity, and what to do")


if __name__ == "__main__":
    unittest.main()
