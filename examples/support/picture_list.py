# SPDX-License-Identifier: MIT
"""The runs from which the pictures in docs/images are drawn, and whether they are up to date.

    for source in SOURCES: source.pictures, source.runs(...), source.shown(folder)
    drawing_of("broken_tower")                 digest of the Python code that draws
    changed_options(source, recorded)          options whose defaults have changed

docs/images/made_from.json has an entry for each source: the commands, the digests of the pictures
and of the drawing code, the options of the runs, and the results that are visible in the pictures.
examples/pictures and examples/gallery write it, tests/examples/check_pictures.py reads it. For the
programs of the tutorial the options are replaced by a digest of the program, and the results by what
it printed.
"""

import ast
import hashlib
import io
import json
import math
import os
import pathlib
import re
import subprocess
import tokenize

EXAMPLES = pathlib.Path(__file__).resolve().parents[1]
IMAGES = EXAMPLES.parent / "docs" / "images"
RECORD = IMAGES / "made_from.json"
NOT_COMPARED = ("threads", "out")  # of the options: they change nothing in a picture


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def dam_break_shown(folder):
    from support.water import DamBreak

    run = DamBreak(folder)
    edge, height = run.errors_of_potential_flow()
    return {"particles_lost": run.summary["particles_lost"], "time_shift": run.time_shift(),
            "front_error": run.front_error(), "height_error": run.height_error(),
            "front_error_of_potential_flow": edge, "height_error_of_potential_flow": height}


def tower_shown(folder):
    shown = {}
    for name, run in (("damped", folder), ("undamped", folder / "undamped")):
        summary = summary_of(run)
        shown |= {f"{name}_{key}": summary[key]
                  for key in ("particles", "escaped", "pile_radius", "farthest")}
    return shown


def hopper_shown(folder):
    return {f"rate_{rate['opening_over_d']:g}_d": rate["rate"]
            for rate in summary_of(folder)["rates"]}


def flow_shown(folder):
    # The final number of bodies of fluid is random.
    return {finding["quantity"]: finding["measured"] for finding in summary_of(folder)["findings"]
            if "one body" not in finding["quantity"]}


class Drawn:
    """Has pictures: names in docs/images by the names used by the script that draws them."""

    def picked_by(self):
        """Names by which it is chosen on the command line."""
        return list(self.pictures.values())


class Source(Drawn):
    """The runs of a program, by subfolder, that its plot script draws together.

    shown(folder): visible results.
    """

    def __init__(self, name, program, runs, pictures, shown):
        self.name, self.program, self.runs, self.pictures = name, program, runs, pictures
        self.shown = shown
        self.drawn_by = f"plot_{program}.py"

    def command_of(self, subfolder):
        options = [f"--{name}={value}" for name, value in self.runs[subfolder].items()]
        return [self.program, *options]

    def run(self, programs, folder, threads):
        """Runs the programs in subfolders; raises CalledProcessError if one fails."""
        for subfolder in self.runs:
            (folder / subfolder).mkdir(parents=True, exist_ok=True)
            program, *options = self.command_of(subfolder)
            subprocess.run([programs / program, *options, "--threads", str(threads), "--out",
                            folder / subfolder], check=True)

    def drawing_command(self, folder):
        return [self.drawn_by, folder]

    def record(self, folder):
        """What is compared with a later run."""
        return {"options": self.options_of(folder), "shown": self.shown(folder)}

    def options_of(self, folder):
        """Options of the runs in a folder, without those that do not affect a picture."""
        return {subfolder: {name: value for name, value in
                            summary_of(folder / subfolder)["options"].items()
                            if name not in NOT_COMPARED} for subfolder in self.runs}

    def command_lines(self):
        folder = f"out/pictures/{self.name}"
        return [" ".join(["examples/run", *self.command_of(subfolder), "--out",
                          folder + ("/" + subfolder if subfolder else "")])
                for subfolder in self.runs] + [self.drawing_line(folder)]

    def drawing_line(self, folder):
        return "examples/" + " ".join(self.drawing_command(folder))


class GalleryItem(Source):
    """A film or picture of docs/gallery.md. short: options of a run for tests, which takes seconds;
    drawn_by: the script, if it is not that for all in 2D or in 3D."""

    def __init__(self, name, program, options=None, short=None, drawn_by=None):
        super().__init__(f"gallery/{name}", program, {"": options or {}},
                         {f"{name}.webp": f"gallery/{name}.webp"}, None)
        self.short_name = name
        self.short = short or {}
        self.is_3d = name.endswith("_3d")
        self.drawn_by = drawn_by or f"draw_gallery_{'3d' if self.is_3d else '2d'}.py"

    def picked_by(self):
        return [self.short_name]

    def drawing_command(self, folder):
        return [self.drawn_by, self.short_name, folder]

    def command_of(self, subfolder, is_short=False):
        options = self.runs[subfolder] | (self.short if is_short else {})
        return [self.program, *(f"--{name}={value}" for name, value in options.items())]

    def record(self, folder):
        return {"options": self.options_of(folder)} if self.has_options else {}

    @property
    def has_options(self):
        """Whether the program has options; the others write to the current folder."""
        return '"--out"' in program_text(self.program)

    def command_lines(self):
        if self.has_options:
            return super().command_lines()
        return [f"examples/run {self.program}", self.drawing_line(f"out/{self.program}")]


class Step(Drawn):
    """A program of the tutorial, and the script that draws one of the files that it writes."""

    def __init__(self, name, drawn_by, file, *options):
        self.name, self.program = f"tutorial_{name}", f"tutorial/{name}"
        self.drawn_by, self.file, self.options = drawn_by, file, options
        self.pictures = {"picture.png": f"{self.name}.png"}

    def run(self, programs, folder, threads):
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / "printed.txt", "w", encoding="utf-8") as printed:
            subprocess.run([programs.absolute() / self.program], cwd=folder, check=True,
                           stdout=printed, env={**os.environ, "OMP_NUM_THREADS": str(threads)})

    def drawing_command(self, folder):
        return [self.drawn_by, folder / self.file, folder / "picture.png", *self.options]

    def record(self, folder):
        printed = (folder / "printed.txt").read_text(encoding="utf-8")
        return {"program": self.program_digest(), "shown": {"printed": printed.splitlines()}}

    def program_digest(self, examples=EXAMPLES):
        """Of the program without its comments and empty lines."""
        rows = re.sub(r"//.*", "", program_text(self.program, examples)).splitlines()
        return digest_of("\n".join(row.rstrip() for row in rows if row.strip()).encode())

    def command_on_page(self):
        picture = pathlib.PurePosixPath(self.file).with_suffix(".png")
        return " ".join([f"examples/{self.drawn_by} out/{self.file} out/{picture}", *self.options])

    def command_lines(self):
        return [self.program, self.command_on_page()]


class Study(Drawn):
    """Long runs, done and drawn by a separate script. argv: arguments of that script."""

    def __init__(self, name, command, drawn_by, argv, pictures):
        self.name, self.command, self.drawn_by, self.argv = name, command, drawn_by, argv
        self.pictures = pictures

    def command_lines(self):
        return [self.command]


SOURCES = [
    Source("dam_break", "dam_break", {"": {}},
           {"frames.png": "dam_break.png", "front.png": "dam_break_front.png"}, dam_break_shown),
    Source("broken_tower", "broken_tower", {"": {}, "undamped": {"alpha": 0}},
           {"frames.png": "broken_tower.png"}, tower_shown),
    Source("hopper", "hopper", {"": {"dimension": 2, "openings": 20}}, {"frames.png": "hopper.png"},
           hopper_shown),
    Source("oscillating_drop", "fluid_cases", {"": {"case": "oscillating_drop", "spacing": 0.05}},
           {"history.png": "oscillating_drop.png"}, flow_shown),
    Source("rotating_square", "fluid_cases", {"": {"case": "rotating_square", "spacing": 0.02}},
           {"frames.png": "rotating_square.png"}, flow_shown),
    Source("floating_body", "floating_body", {"": {"hold": "both", "until": 2}},
           {"motion.png": "floating_body.png"}, flow_shown),
    Source("wave_maker", "wave_maker",
           {"": {"spacing": 0.02, "length": 6, "until": 8.6, "output-every": 0.05}},
           {"levels.png": "wave_maker.png"}, flow_shown),
    Source("sloshing", "sloshing", {"": {"spacing": 0.02, "until": 6}},
           {"centre.png": "sloshing.png"}, flow_shown),
    Source("channel", "channel", {"": {"until": 4, "output-every": 0.05}},
           {"frames.png": "channel.png", "theory.png": "channel_theory.png"}, flow_shown),
]
STEPS = [
    Step("first_fall", "draw_frames.py", "fall.pvd"),
    Step("first_flow", "draw_frames.py", "splash.pvd", "--field", "pressure"),
    Step("own_law", "draw_frames.py", "wet.pvd"),
    Step("own_field", "draw_frames.py", "drum.pvd", "--field", "colour"),
    Step("compare", "tutorial/draw_front.py", "front.csv"),
    Step("grains_in_water", "tutorial/draw_both.py", "rain.pvd"),
]
SOURCES += STEPS
MOVING = "draw_gallery_moving.py"
IN_WATER = "draw_gallery_grains.py"
COLLAPSE = "draw_gallery_collapse.py"
GALLERY = [
    GalleryItem("broken_tower_3d", "broken_tower",
                {"dimension": 3, "columns": 8, "depth": 8, "until": 1.6, "output-every": 0.04},
                {"columns": 4, "depth": 4, "rows": 10, "until": 0.12}),
    GalleryItem("dam_break_3d", "dam_break",
                {"dimension": 3, "spacing": 0.025, "depth": 0.4, "until": 1.2,
                 "output-every": 0.025},
                {"spacing": 0.05, "until": 0.1}),
    GalleryItem("hopper_3d", "hopper",
                {"openings": 7, "width": 14, "fill-height": 16, "half-angle": 50,
                 "share": 0.8, "longest": 40},
                {"width": 10, "fill-height": 8, "openings": 5, "stiffness": 1000}),
    GalleryItem("vibrating_floor_3d", "vibrating_floor",
                {"loading-stiffness": 2.7e6, "warm-up": 1, "until": 1.4, "frames-every": 0.02},
                {"cell-width": 4, "warm-up": 0.1, "until": 0.5, "frames-every": 0.1}),
    GalleryItem("broken_tower_2d", "broken_tower", {"until": 2.4, "output-every": 0.04},
                {"columns": 4, "rows": 10, "until": 0.12}),
    GalleryItem("dam_break_2d", "dam_break", {"until": 1.2, "output-every": 0.02},
                {"spacing": 0.04, "until": 0.08}),
    GalleryItem("hopper_2d", "hopper",
                {"dimension": 2, "openings": 9, "width": 26, "fill-height": 32, "half-angle": 60,
                 "share": 0.8},
                {"width": 20, "fill-height": 20, "openings": 8, "stiffness": 1000}),
    GalleryItem("rotating_square", "fluid_cases",
                {"case": "rotating_square", "spacing": 0.02, "frames": 60},
                {"spacing": 0.1, "until": 0.5, "frames": 4}),
    GalleryItem("oscillating_drop", "fluid_cases",
                {"case": "oscillating_drop", "spacing": 0.05, "frames": 60},
                {"spacing": 0.2, "until": 0.5, "frames": 4}),
    GalleryItem("taylor_green", "fluid_cases",
                {"case": "taylor_green", "spacing": 0.02, "frames": 50},
                {"spacing": 0.1, "until": 0.2, "frames": 4}),
    GalleryItem("wave_maker", "wave_maker",
                {"period": 0.7, "stroke": 0.03, "length": 2, "far-end": "sponge", "far-length": 0.7,
                 "spacing": 0.01, "until": 5, "output-every": 0.05},
                {"spacing": 0.04, "until": 0.2}, MOVING),
    GalleryItem("floating_body", "floating_body",
                {"width": 0.2, "height": 0.2, "tilt": 5, "offset": 0.05, "length": 1.2, "until": 3,
                 "output-every": 0.04},
                {"spacing": 0.04, "until": 0.12}, MOVING),
    GalleryItem("sloshing", "sloshing",
                {"amplitude": 0.015, "periods": 3, "spacing": 0.005, "until": 3, "output-every": 0.04},
                {"spacing": 0.02, "until": 0.12}, MOVING),
    GalleryItem("hydraulic_jump", "channel",
                {"froude": 3, "length": 3, "until": 3, "output-every": 0.04},
                {"spacing": 0.0125, "until": 0.12}, MOVING),
    GalleryItem("weir", "channel", {"case": "weir", "until": 4, "output-every": 0.05},
                {"spacing": 0.025, "until": 0.15}, MOVING),
    GalleryItem("landslide", "landslide",
                {"dimension": 2, "spacing": 0.0125, "diameter": 0.006, "radius": 4.1, "laplacian-radius": 4.1,
                 "until": 2, "output-every": 0.03},
                {"spacing": 0.025, "diameter": 0.02, "until": 0.1}, IN_WATER),
    GalleryItem("fluidised_bed", "fluidised_bed",
                {"dimension": 3, "spacing": 0.02, "width": 0.16, "bed": 0.14, "stiffness": 1000,
                 "friction-angle": 15, "until": 5, "output-every": 0.08},
                {"spacing": 0.025, "width": 0.15, "bed": 0.06, "until": 0.2}, IN_WATER),
    GalleryItem("submerged_collapse", "submerged_collapse",
                {"dimension": 3, "spacing": 0.0045, "diameter": 0.003, "stiffness": 300, "restitution": 0.3,
                 "friction-angle": 26.6, "viscosity": 1.2e-5, "until": 2, "output-every": 0.04},
                {"length": 0.03, "height": 0.02, "depth": 0.03, "tank": 0.09, "until": 0.05}, COLLAPSE),
    GalleryItem("quickstart_tower", "quickstart_tower"),
    GalleryItem("quickstart_dam", "quickstart_dam"),
    GalleryItem("own_field", "own_field"),
    GalleryItem("own_contact_law", "own_contact_law"),
    GalleryItem("bonded_beam", "bonded_beam"),
]
STUDIES = [
    Study("vibrating_floor", "examples/run --study vibrating_floor", "plot_vibrating_floor.py",
          lambda programs, folder, threads: [
              "study_vibrating_floor.py", programs / "vibrating_floor", folder,
              "--threads", threads],
          {"figures.png": "vibrating_floor.png"}),
    Study("paper", "examples/paper_figures", "paper_figures.py",
          lambda programs, folder, threads: [
              "paper_figures.py", "--out", folder, "--jobs", threads, "--programs", programs],
          {f"fig{k}.png": f"paper_fig{k}.png" for k in (5, 7, 8, 9, 12, 13, 14)}),
]


def digest_of(data):
    return hashlib.sha256(data).hexdigest()[:16]


def code_of(path):
    """The text of a Python file without comments, docstrings and empty lines, and the modules of
    support/ that it imports."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    tree = ast.parse(text)
    modules = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    for node in ast.walk(tree):
        if isinstance(node, documented) and ast.get_docstring(node):
            for row in range(node.body[0].lineno, node.body[0].end_lineno + 1):
                lines[row - 1] = ""
        if isinstance(node, ast.ImportFrom) and node.module == "support":
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("support."):
            modules.add(node.module.split(".")[1])
    return "\n".join(line.rstrip() for line in lines if line.strip()), modules


def drawing_of(script, examples=EXAMPLES):
    """Digest of a script and of all modules of support/ that it imports, without comments."""
    codes, waiting = {}, [examples / script]
    while waiting:
        path = waiting.pop()
        if path in codes:
            continue
        codes[path], modules = code_of(path)
        waiting += [examples / "support" / f"{name}.py" for name in modules]
    return digest_of("\0".join(codes[path] for path in sorted(codes)).encode())


def program_text(program, examples=EXAMPLES):
    """An example's source and the headers of support/ that it includes."""
    text, waiting, done = "", [f"{program}.cpp"], set()
    while waiting:
        name = waiting.pop()
        if name in done or not (examples / name).exists():
            continue
        done.add(name)
        part = (examples / name).read_text(encoding="utf-8")
        text += part
        for included in re.findall(r'^#include "([^"]+)"', part, re.MULTILINE):
            waiting += [included, str(pathlib.PurePosixPath(name).parent / included)]
    return text


def changed_options(source, recorded, examples=EXAMPLES):
    """Messages about numeric options whose present defaults differ from those of the runs. Options
    that are given in the command, or that are not plain numbers in the source, are checked only by
    running the program."""
    text = program_text(source.program, examples)
    messages = []
    for subfolder, options in recorded.items():
        given = {name.replace("-", "_") for name in source.runs.get(subfolder, {})}
        for name, value in options.items():
            if name in given or isinstance(value, bool) or not isinstance(value, (int, float)):
                continue
            if not re.search(rf'"{name}"(,|\] =)\s*o\.(\w+\.)?{name}[;}}]', text):
                continue
            defaults = re.findall(rf"\b(?:double|int|Index|unsigned) {name} = ([-+.\de]+);", text)
            if defaults and float(defaults[0]) != 0 and not math.isclose(float(defaults[0]), value):
                messages.append(f"its run had {name} = {value:g}, but {source.program} now has "
                                f"{defaults[0]}")
    return messages
