#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tests the Python modules of the examples: which runs are repeated, and how they are evaluated.

    check.py EXAMPLES_FOLDER

The tests of the evaluation need NumPy; without it they are skipped.
"""

import importlib.util
import json
import math
import pathlib
import subprocess
import sys
import tempfile

# Ends as given by --how, and records its calls.
PROGRAM = """#!{python}
import json, pathlib, sys
options = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
out = pathlib.Path(options.pop("out"))
with open(out / "calls", "a") as calls:
    calls.write("x")
if options["how"] == "fails":
    sys.exit("program: the solve stopped")
(out / "summary.json").write_text(json.dumps({{"options": {{"how": options["how"]}}}}))
"""


def test_runs(folder):
    from support.runs import Run, has_options, run_all

    program = folder / "program"
    program.write_text(PROGRAM.format(python=sys.executable))
    program.chmod(0o755)
    runs = [Run(folder / "done", program, {"how": "well"}),
            Run(folder / "failed", program, {"how": "fails"})]
    for _ in range(2):
        run_all(runs, jobs=2)
    assert runs[0].is_done() and runs[0].failure() is None
    assert not runs[1].is_done() and runs[1].failure() == "program: the solve stopped"
    for run in runs:
        assert (run.folder / "calls").read_text() == "x", "a run is not repeated"
    other = Run(folder / "done", program, {"how": "otherwise"})
    assert not other.is_done(), "other options make another run"
    # A killed run has neither file.
    (folder / "done" / "summary.json").unlink()
    run_all(runs, jobs=1)
    assert (folder / "done" / "calls").read_text() == "xx"
    (folder / "broken.json").write_text("{")
    assert not has_options(folder / "broken.json", {})


def test_plan(folder):
    from support.paper_study import Estimate, Study

    study = Study(folder, {"hydrostatic": "h", "dam_break": "d"})
    figures = ("fig5", "fig7", "fig8", "fig9", "fig12", "fig13", "fig14")
    options_of = {}
    for figure in figures:
        for run in study.runs_for(figure):
            assert options_of.setdefault(run.folder, run.options) == run.options, \
                "one folder, one set of options"
    assert Estimate([]).text() == "–"
    assert Estimate([1.0]).text() == "1.00"
    assert Estimate([1.0, None, 3.0]).text() == "2.00 ± 1.00"


def test_modules(folder):
    program = folder / "draws"
    program.write_text(f"import sys\nsys.path.insert(0, {sys.path[0]!r})\n"
                       "from support.modules import need\nneed('json', 'no_such_module')\n")
    end = subprocess.run([sys.executable, program], capture_output=True, text=True)
    assert end.returncode == 3, "the exit code of a script that draws nothing"
    assert f"needs no_such_module, which {sys.executable} lacks" in end.stderr, end.stderr


def write_tank(folder, waves, high):
    import numpy as np

    folder.mkdir()
    t = np.arange(0, 2, 1e-3)
    p = 4000 + 100 * np.sin(2 * np.pi * waves * t) + high * (-1.0) ** np.arange(len(t))
    rows = "\n".join(f"{a:.6g},{b:.8g}" for a, b in zip(t, p))
    (folder / "pressure.csv").write_text(f"t,p_1\n{rows}\n")
    depth = np.arange(0.005, 0.4, 0.01)
    rows = "\n".join(f"{z:.6g},{9810 * (z - 0.005):.8g},1" for z in depth)
    (folder / "profile.csv").write_text(f"depth,p_mean,p_std\n{rows}\n")
    (folder / "summary.json").write_text(json.dumps({"options": {}}))


def test_measures(folder):
    import numpy as np

    from support.paper_results import Finding, decreases_with_a, is_below
    from support.paper_study import Estimate
    from support.water import Tank

    write_tank(folder / "slow", waves=1, high=0)
    write_tank(folder / "fast", waves=1, high=30)
    assert Tank(folder / "slow").roughness(0.5) < 0.3, "a slow wave is not rough"
    assert abs(Tank(folder / "fast").roughness(0.5) - 30) < 2, "oscillations faster than 0.02 s are"
    assert Tank(folder / "fast").roughness(1.99) is None, "too short for the moving average"
    assert 4098 < Tank(folder / "fast").peak(0.5) < 4103
    slope, zero, off = Tank(folder / "slow").line()
    assert math.isclose(slope, 1) and math.isclose(zero, 0.005) and off < 1e-6

    smooth, rough = Estimate([1.0, 1.1, 0.9]), Estimate([2.0, 2.1, 1.9])
    assert is_below("", smooth, rough).verdict() == "reproduced"
    assert is_below("", rough, smooth).verdict() == "**not reproduced**"
    assert is_below("", smooth, rough, factor=0.51).verdict() == "reproduced, within the error bar"
    assert is_below("", smooth, Estimate([])).verdict() == "undetermined"
    assert Finding("", "", True).verdict() == "reproduced"
    a, b = np.meshgrid(np.arange(7.0), np.arange(5.0), indexing="ij")
    assert decreases_with_a(10 - a, "").verdict() == "reproduced"
    assert decreases_with_a(10 + a, "").verdict() == "**not reproduced**"
    assert "within" in decreases_with_a(np.where((a + b) % 2 == 0, 1.0, np.nan), "").verdict()


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    sys.path.insert(0, arguments[0])
    tests = [test_runs, test_plan, test_modules]
    if importlib.util.find_spec("numpy"):
        tests.append(test_measures)
    for test in tests:
        with tempfile.TemporaryDirectory() as name:
            test(pathlib.Path(name))
        print(f"{test.__name__}: passed")


if __name__ == "__main__":
    main(sys.argv[1:])
