# SPDX-License-Identifier: MIT
"""Steps and runs: observers, errors, Ctrl-C, threads, checkpoints."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import traceback
import unittest

import numpy as np
from simulations import R, bits, grains, spheres, water

import silt


class Runs(unittest.TestCase):
    def test_end_after_the_given_time(self):
        for simulation in (grains(), spheres(), water()):
            simulation.run(until=0.02)
            self.assertGreaterEqual(simulation.time, 0.02 * (1 - 1e-9))
            self.assertLess(simulation.time - simulation.last_time_step, 0.02)
            simulation.run(until=0.03, end_exactly=True)
            self.assertEqual(simulation.time, 0.03)

    def test_are_the_same_steps_as_single_ones(self):
        one, other = grains(), grains()
        one.run(until=0.1)
        while other.time < 0.1 * (1 - 1e-12):
            other.step()
        third = grains()
        third.step(one.steps)
        self.assertEqual(bits(one), bits(other))
        self.assertEqual(bits(one), bits(third))

    def test_use_the_given_time_step(self):
        simulation = grains()
        simulation.step(time_step=1e-5)
        self.assertEqual(simulation.last_time_step, 1e-5)
        simulation.run(until=1e-3, time_step=2e-5)
        self.assertEqual(simulation.last_time_step, 2e-5)
        self.assertGreater(simulation.time_step(), 2e-5)

    def test_may_be_repeated(self):
        simulation = grains()
        simulation.run(until=0.01)
        steps = simulation.steps
        simulation.run(until=0.01)
        self.assertEqual(simulation.steps, steps)

    def test_refuse_bad_arguments(self):
        simulation = grains()
        simulation.run(until=0.05)
        before = bits(simulation)
        for bad in ({"until": 0.01}, {"until": -1}, {"until": float("nan")}, {"until": float("inf")},
                    {"until": "soon"}, {"until": None}, {"until": 1, "output_every": -1},
                    {"until": 1, "output_every": float("nan")}, {"until": 1, "output_every": 1e-14},
                    {"until": 1, "time_step": 0}, {"until": 1, "time_step": -1e-5}, {"until": 1, "time_step": 1e-20},
                    {"until": 1, "time_step": float("nan")}, {"until": 1, "time_step": "short"},
                    {"until": 1, "time_step": 1}, {"until": 1, "end_exactly": "no"}, {"until": 1, "observer": 3},
                    {"until": 1, "observer": [print, None]}):
            with self.assertRaises(silt.Error, msg=repr(bad)) as caught:
                simulation.run(**bad)
            self.assertEqual(caught.exception.what, str(caught.exception))
            self.assertGreater(len(caught.exception.what), 20)
        with self.assertRaisesRegex(silt.Error, r"run\(until, time_step="):
            grains(position=np.zeros((0, 2)), radius=R).step()
        for bad in ({"count": -1}, {"count": 0.5}, {"count": "two"}, {"count": 2**70}, {"time_step": 0},
                    {"time_step": []}):
            with self.assertRaises(silt.Error, msg=repr(bad)):
                simulation.step(**bad)
        with self.assertRaises(TypeError):
            simulation.run()
        with self.assertRaises(TypeError):
            simulation.run(1, end=True)
        self.assertEqual(bits(simulation), before)

    def test_that_fail_tell_where_and_change_nothing(self):
        simulation = grains()
        simulation.step(5)
        place = int(np.flatnonzero(simulation.ids == 7)[0])
        simulation["velocity"][place] = np.nan
        before = bits(simulation)
        with self.assertRaisesRegex(silt.Error, "velocity") as caught:
            simulation.run(until=1)
        self.assertEqual((caught.exception.id, caught.exception.step), (7, 5))
        self.assertEqual(caught.exception.time, simulation.time)
        self.assertEqual(bits(simulation), before)
        simulation["velocity"][place] = 0
        simulation.step()

    def test_refuse_grains_that_columns_made_impossible(self):
        for field, value in (("radius", -1), ("radius", 0), ("radius", np.inf), ("mass", 0), ("mass", np.nan),
                             ("inertia", -1), ("material", 3), ("position", np.inf), ("radius", 100)):
            simulation = grains()
            simulation[field][4] = value
            with self.assertRaises(silt.Error, msg=f"{field} = {value}"):
                simulation.step()
            self.assertEqual(simulation.steps, 0)


class Observers(unittest.TestCase):
    def test_are_called_at_outputs(self):
        for simulation in (grains(), water()):
            seen = []
            simulation.run(until=0.03, output_every=0.01, observer=lambda s: seen.append((s, s.time)))  # noqa: B023
            self.assertEqual(len(seen), 4)
            self.assertTrue(all(each is simulation for each, _ in seen))
            for k, (_, time) in enumerate(seen):
                self.assertGreaterEqual(time, 0.01 * k * (1 - 1e-9))
                self.assertLess(time, 0.01 * k + simulation.last_time_step * 1.5)

    def test_may_be_several(self):
        calls = []
        grains().run(0.01, 0.005, [lambda _: calls.append("a"), lambda _: calls.append("b")])
        self.assertEqual(calls, ["a", "b"] * 3)
        with tempfile.TemporaryDirectory() as folder:
            frames = silt.VtkSeries(pathlib.Path(folder) / "frames")
            grains().run(0.01, 0.005, (frames, lambda _: calls.append("c")))
            self.assertEqual(frames.frames, 3)
            self.assertEqual(len(list(pathlib.Path(folder).glob("frames/*.vtu"))), 3)
            self.assertIn("frames_000002.vtu", (pathlib.Path(folder) / "frames.pvd").read_text())
        self.assertEqual(calls[6:], ["c"] * 3)

    def test_raise_through_the_run(self):
        class Own(Exception):
            pass

        simulation, undisturbed = grains(), grains()
        undisturbed.run(until=0.03)

        def fails(s):
            if s.time > 0.012:
                raise Own("mine", 3)

        try:
            simulation.run(until=0.03, output_every=0.005, observer=fails)
            self.fail("nothing was raised")
        except Own as error:
            self.assertEqual(error.args, ("mine", 3))
            self.assertIn("fails", [frame.name for frame in traceback.extract_tb(error.__traceback__)])
        self.assertGreater(simulation.time, 0.012)
        self.assertLess(simulation.time, 0.03)
        simulation.run(until=0.03)
        self.assertEqual(bits(simulation), bits(undisturbed))

    def test_may_raise_anything(self):
        for error in (SystemExit(3), KeyboardInterrupt(), StopIteration(), silt.Error("own"), MemoryError()):
            simulation = grains()

            def fails(_, error=error):
                raise error

            with self.assertRaises(type(error)) as caught:
                simulation.run(until=0.01, observer=fails)
            self.assertIs(caught.exception, error)
            simulation.step()

    def test_may_change_the_simulation(self):
        one, other = grains(), grains()

        def push(s):
            if s.steps > 0:
                s["velocity"] += [1, 0]
                s.remove(5)
                s.set_wall_present(0, False)

        with self.assertRaises(silt.Error):  # there is no grain 5 at the next output
            one.run(until=0.02, output_every=0.01, observer=push)
        other.run(until=0.01)
        other["velocity"] += [1, 0]
        other.remove(5)
        other.set_wall_present(0, False)
        other.run(until=0.02)
        other["velocity"] += [1, 0]
        self.assertEqual(bits(one), bits(other))

    def test_must_not_advance_or_replace_their_simulation(self):
        simulation = grains()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            simulation.write_checkpoint(file)
            for act in (lambda s: s.step(), lambda s: s.run(until=1), lambda s: s.read_checkpoint(file)):
                with self.assertRaisesRegex(silt.Error, "observer"):
                    simulation.run(until=0.01, observer=act)
        other = grains()
        simulation.run(until=0.01, output_every=0.001, observer=lambda s: other.run(until=s.time))
        self.assertGreaterEqual(other.time, 0.01)

    def test_must_not_keep_views(self):
        simulation, kept = grains(), []
        with self.assertRaisesRegex(silt.Error, "observer.*position"):
            simulation.run(until=0.01, observer=lambda s: kept.append(s["position"].view()))
        self.assertEqual(simulation.steps, 0)
        kept.clear()
        simulation.run(until=0.01, output_every=0.002, observer=lambda s: kept.append(s["position"][:]))
        self.assertFalse(np.array_equal(kept[0], kept[-1]))


class Interrupts(unittest.TestCase):
    """Ctrl-C is SIGINT to this process while it runs; the test would last for hours without it."""

    def interrupted(self, call):
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            call()
        timer.join()

    def test_end_runs_and_steps_between_two_steps(self):
        for make in (grains, spheres, water):
            simulation, undisturbed = make(), make()
            self.interrupted(lambda s=simulation: s.run(until=1e3))
            self.assertGreater(simulation.steps, 0)
            if simulation.steps < 20000:
                undisturbed.step(simulation.steps)
                self.assertEqual(bits(simulation), bits(undisturbed))
            self.interrupted(lambda s=simulation: s.step(10**12))
            simulation.run(until=simulation.time + 0.001)

    def test_reach_observers(self):
        simulation = grains()

        def waits(_):
            threading.Event().wait(1e4)

        self.interrupted(lambda: simulation.run(until=1e3, observer=waits))
        simulation.step()

    def test_do_not_repeat_outputs(self):
        simulation, times = grains(), []
        self.interrupted(lambda: simulation.run(1e3, 1e-3, lambda s: times.append(s.time)))
        simulation.run(simulation.time + 0.01, 1e-3, lambda s: times.append(s.time))
        self.assertEqual(len(times), len(set(times)))


class Threads(unittest.TestCase):
    def test_of_python_run_beside_a_run(self):
        simulation, beats, ended = grains(), [], threading.Event()

        def beat():
            while not ended.is_set():
                beats.append(simulation)

        thread = threading.Thread(target=beat)
        thread.start()
        while len(beats) < 10:  # hours, if the lock of the interpreter is kept
            simulation.step(200)
        ended.set()
        thread.join()

    def test_have_no_access_during_a_run_in_another_one(self):
        simulation, running, goes_on = grains(), threading.Event(), threading.Event()
        failures = []

        def observe(_):
            running.set()
            goes_on.wait()

        def run():
            try:
                simulation.run(until=0.01, observer=observe)
            except Exception as error:  # noqa: BLE001
                failures.append(error)

        column = simulation["position"]
        thread = threading.Thread(target=run)
        thread.start()
        running.wait()
        for call in (lambda: simulation["position"], lambda: column[:], column.view, lambda: simulation.time,
                     simulation.step, lambda: simulation.run(until=1), lambda: simulation.remove(1),
                     simulation.energies, simulation.snapshot, lambda: len(simulation), lambda: simulation.ids,
                     lambda: column.__setitem__(0, 0), lambda: simulation.set_wall_present(0, False)):
            with self.assertRaisesRegex(silt.Error, "another thread"):
                call()
        goes_on.set()
        thread.join()
        self.assertEqual(failures, [])
        self.assertGreaterEqual(simulation.time, 0.01)

    def test_run_simulations_side_by_side_with_the_same_bits(self):
        alone = [make() for make in (grains, spheres, water)]
        beside = [make() for make in (grains, spheres, water) for _ in range(2)]
        for simulation in alone:
            simulation.run(until=0.1, output_every=0.01, observer=lambda s: s.energies())
        threads = [threading.Thread(target=each.run, args=(0.1, 0.01, lambda s: s.energies())) for each in beside]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for place, simulation in enumerate(beside):
            self.assertEqual(bits(simulation), bits(alone[place // 2]))

    def test_of_any_number_give_the_same_bits(self):
        results = []
        for number in (1, 3):
            silt.use_threads(number)
            simulation = water()
            simulation.run(until=0.05)
            results.append(bits(simulation))
        silt.use_threads(1)
        self.assertEqual(results[0], results[1])
        for bad in (0, -1, 0.5, "all", 2**40):
            with self.assertRaises(silt.Error):
                silt.use_threads(bad)

    def test_may_release_a_simulation_while_another_one_runs_it(self):
        simulation = grains()
        thread = threading.Thread(target=simulation.run, args=(0.2,))
        thread.start()
        del simulation
        thread.join()


class EndOfTheInterpreter(unittest.TestCase):
    def check(self, program):
        for _ in range(5):
            ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
            self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (5, "", ""))

    def test_is_no_crash_while_other_threads_run_simulations(self):
        program = (
            "import atexit, sys, threading\n"
            f"sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})\n"
            "later = []\n"
            "atexit.register(lambda: later[0].run(until=0.01))\n"  # after that of the package
            "from simulations import grains, water\n"
            "later.append(grains())\n"
            "begun = threading.Semaphore(0)\n"
            "for simulation in (grains(), grains(), water()):\n"
            "    run = (1e4, 1e-3, lambda s: begun.release())\n"
            "    threading.Thread(target=simulation.run, args=run, daemon=True).start()\n"
            "for _ in range(30):\n"
            "    begun.acquire()\n"
            "view = later[0]['mass'].view()\n"
            "del view\n"
            "sys.exit(5)\n")
        self.check(program)

    def test_is_no_crash_while_an_observer_is_in_python(self):
        program = (
            "import sys, threading\n"
            f"sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})\n"
            "from simulations import grains\n"
            "begun = threading.Event()\n"
            "def observe(simulation):\n"
            "    begun.set()\n"
            "    while True:\n"
            "        simulation['position'][:] + 1\n"
            "threading.Thread(target=grains().run, args=(1, 1e-3, observe), daemon=True).start()\n"
            "begun.wait()\n"
            "sys.exit(5)\n")
        self.check(program)


@unittest.skipUnless(hasattr(os, "fork"), "this system has no fork")
class Forks(unittest.TestCase):
    def test_make_steps_with_one_thread(self):
        program = (
            "import multiprocessing, sys\n"
            f"sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})\n"
            "import silt\n"
            "from simulations import bits, grains\n"
            "silt.use_threads(2)\n"
            "heap = grains(position=silt.lattice((-1, 0.1), (1, 2.1), 0.04))\n"
            "heap.step(10)\n"
            "def go_on(results):\n"
            "    heap.step(10)\n"
            "    try:\n"
            "        silt.use_threads(2)\n"
            "    except silt.Error as error:\n"
            "        results.send((bits(heap), error.what))\n"
            "fork = multiprocessing.get_context('fork')\n"
            "results, ours = fork.Pipe()\n"
            "child = fork.Process(target=go_on, args=(ours,))\n"
            "child.start()\n"
            "if not results.poll(60):\n"
            "    child.kill()\n"
            "    sys.exit('the steps of the child do not end')\n"
            "state, sentence = results.recv()\n"
            "child.join()\n"
            "heap.step(10)\n"
            "assert state == bits(heap)\n"
            "assert 'spawn' in sentence\n")
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False,
                               timeout=120)
        self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (0, "", ""))


class Checkpoints(unittest.TestCase):
    def test_continue_with_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            for make in (grains, spheres, water):
                file = pathlib.Path(folder) / make.__name__
                one, other = make(), make()
                one.run(until=0.05)
                one.write_checkpoint(file)
                one.run(until=0.1)
                other.read_checkpoint(str(file))
                self.assertEqual(other.time, other.time)
                other.run(until=0.1)
                self.assertEqual(bits(one), bits(other))

    def test_of_other_simulations_are_refused(self):
        other_law = silt.CundallStrack(normal_stiffness=2e6, tangential_stiffness=5e5, restitution=0.5)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            grains().write_checkpoint(file)
            for other in (grains(law=other_law), grains(walls=[silt.Plane(normal=(0, 1), point=(0, -1))]),
                          grains(walls=[]), spheres(), water()):
                before = bits(other)
                with self.assertRaises(silt.Error):
                    other.read_checkpoint(file)
                self.assertEqual(bits(other), before)
            file.write_bytes(file.read_bytes()[:-9])
            for bad in (file, folder, folder + "/none", "", 3, b"\0", "a\0b"):
                with self.assertRaises(silt.Error, msg=repr(bad)):
                    grains().read_checkpoint(bad)
            with self.assertRaisesRegex(silt.Error, "accepts_other_setup"):
                grains().read_checkpoint(file, accepts_other_setup="no")
            for bad in (folder, folder + "/none/state", "", None):
                with self.assertRaises(silt.Error, msg=repr(bad)):
                    grains().write_checkpoint(bad)

    def test_of_other_arguments_are_refused_by_name(self):
        box = silt.Box(lower=(-1, -1), upper=(1, 1))
        of_grains = {
            "gravity = (0, -9.81), but here it is (1, -9.81)": {"gravity": (1, -9.81)},
            "damping = 0, but here it is 0.5": {"damping": 0.5},
            "steps_per_contact = 50, but here it is 60": {"steps_per_contact": 60},
            "max_overlap = 0.5, but here it is 0.25": {"max_overlap": 0.25},
            "box: upper = (1, 1), but here it is (1, 2)": {"box": silt.Box(lower=(-1, -1), upper=(1, 2))},
            "box: lower = (-1, -1), but here it is (-inf, -inf)": {"box": None},
            "box: periodic = (False, False), but here it is (True, False)":
                {"box": silt.Box(lower=(-1, -1), upper=(1, 1), periodic=(True, False)), "walls": []},
            "box: on_escape = 'refuse', but here it is 'remove'":
                {"box": silt.Box(lower=(-1, -1), upper=(1, 1), on_escape="remove")},
        }
        of_water = {
            "on_escape = 'refuse', but here it is 'remove'": {"on_escape": "remove"},
            "another gravity": {"gravity": (0, -1)},
            "another tank, lid, wall, motion, opening or body": {"lid": True},
        }
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            for make, cases in ((lambda **given: grains(**({"box": box} | given)), of_grains), (water, of_water)):
                for sentence, further in cases.items():
                    written = make(walls=[]) if "walls" in further else make()
                    written.step(5)
                    written.write_checkpoint(file)
                    other = make(**further)
                    before = bits(other)
                    with self.assertRaisesRegex(silt.Error, "accepts_other_setup=True$") as caught:
                        other.read_checkpoint(file)
                    self.assertIn("was written with " + sentence, caught.exception.what)
                    self.assertEqual((bits(other), other.time), (before, 0))
                    other.read_checkpoint(file, accepts_other_setup=True)
                    # A snapshot depends on the forces of the arguments.
                    for field in written.fields:
                        self.assertTrue(np.array_equal(other[field], written[field]), field)
                    self.assertEqual(other.time, written.time)
                    other.step()

    def test_restore_radii_and_densities(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "state"
            written, other = grains(), grains(radius=0.01, density=1000, velocity=1)
            written.write_checkpoint(file)
            other.read_checkpoint(file)
            written.step(50)
            other.step(50)
            self.assertEqual(bits(written), bits(other))


if __name__ == "__main__":
    sys.exit(unittest.main())
