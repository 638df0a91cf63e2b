# SPDX-License-Identifier: MIT
"""Runs the examples of the package, and compares two with the C++ programs of the same set-up.

    examples_test.py EXAMPLES TOWER DAM

EXAMPLES is the folder of the scripts, TOWER and DAM are programs that print the hash of their state.
"""

import contextlib
import importlib.util
import io
import os
import pathlib
import runpy
import subprocess
import sys
import tempfile
import unittest

from simulations import hash_of

FOLDER, PROGRAMS = None, {}


class Examples(unittest.TestCase):
    def run_example(self, name):
        """The variables and the output of an example, and the files that it wrote."""
        here, output = pathlib.Path.cwd(), io.StringIO()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(output):
                    variables = runpy.run_path(str(FOLDER / f"{name}.py"))
                return variables, output.getvalue(), sorted(path.name for path in pathlib.Path().rglob("*"))
            finally:
                os.chdir(here)

    def check_same_as_program(self, name):
        variables, _, files = self.run_example(name)
        program = subprocess.run([PROGRAMS[name]], capture_output=True, text=True, check=True)
        self.assertEqual(hash_of(variables[name]), program.stdout.strip())
        self.assertIn(f"{name}.pvd", files)
        self.assertIn(f"{name}_000050.vtu", files)

    def test_tower_ends_with_the_bits_of_the_program(self):
        self.check_same_as_program("tower")

    def test_dam_ends_with_the_bits_of_the_program(self):
        self.check_same_as_program("dam")

    def test_grains_leave_the_hopper_when_its_lid_is_taken_away(self):
        variables, output, _ = self.run_example("hopper")
        discharged = variables["discharged"]
        self.assertEqual(discharged[0], 0)
        self.assertEqual(discharged, sorted(discharged))
        self.assertGreater(discharged[-1], 50)
        self.assertIn(f"{discharged[-1]} of {len(variables['hopper'])} grains", output)

    def test_waves_lift_the_floating_body(self):
        variables, output, files = self.run_example("floating_body")
        heights = variables["heights"]
        self.assertGreater(max(heights) - min(heights), 0.02)
        self.assertLess(max(abs(y - 0.24) for y in heights), 0.06)
        self.assertIn("The box rises and falls by", output)
        self.assertIn("walls_000075.vtu", files)

    def test_water_flows_to_the_lower_side_of_the_basin(self):
        variables, output, _ = self.run_example("basin")
        self.assertAlmostEqual(variables["left"].volume, 0.25 * (0.3 + 0.3 * 0.25 / 0.4 / 2), delta=1e-9)
        self.assertGreater(variables["moved"], 0.1)
        self.assertIn("of water moved by", output)

    def test_water_flows_through_the_channel(self):
        variables, output, _ = self.run_example("channel")
        layer = 0.1 * 0.02  # which enters before the next step
        self.assertAlmostEqual(variables["entered"].volume, 2 * 0.1 * 1.5, delta=1.2 * layer)
        self.assertLess(variables["left"].volume, -0.1)
        self.assertIn("have entered", output)

    def test_sand_sinks_in_water(self):
        variables, output, files = self.run_example("grains_in_water")
        heights = variables["grains"]["position"][:, 2]
        self.assertGreater(variables["sunk"], 0.05)
        self.assertGreater(heights.min(), 0)
        self.assertLess(abs(variables["water"]["position"][:, 2].max() - 0.2), 0.02)
        self.assertIn("The sand has sunk by", output)
        self.assertIn("sand_grains_000025.vtu", files)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "Matplotlib is not installed")
    def test_notebook_sets_up_runs_and_plots(self):
        os.environ["MPLBACKEND"] = "Agg"
        variables, _, _ = self.run_example("notebook")
        figures = variables["plt"].get_fignums()
        self.assertEqual(len(figures), 3)
        x_front = variables["x_front"]
        self.assertGreater(x_front[-1], 2 * x_front[0])
        self.assertTrue((variables["kinetic"] + variables["potential"] <= 1.001 * variables["potential"][0]).all())
        self.assertGreater(variables["tower"]["position"][:, 0].max(), 0.3)


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv[1]).resolve()
    PROGRAMS = {"tower": pathlib.Path(sys.argv[2]).resolve(), "dam": pathlib.Path(sys.argv[3]).resolve()}
    unittest.main(argv=sys.argv[:1])
