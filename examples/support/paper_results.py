# SPDX-License-Identifier: MIT
"""Results of the runs of support/paper_study.py, and whether they reproduce the paper's findings.

    results = Results(study)
    results.case(10).roughness()              an Estimate, from all repetitions
    for finding in findings(results, figures): finding.what, finding.figures, finding.verdict()

Definitions. Roughness: rms of the pressure at P2 minus its moving average over 0.02 s, over the
samples (one per step) of an interval of time that is the same for all compared runs. Peak: maximum
of that average. Error bars: standard errors over the repetitions.
"""

import functools
import math

import numpy as np

from support.paper_study import A, B, CASES, KERNEL_SCHEMES, KERNELS, SCHEMES, Estimate
from support.water import DamBreak, Tank

# About now the wave reflected by the right wall reaches P2; the first impact is over.
LATER_PEAKS = 1.1  # [s]


class Case:
    """The repetitions of one case of the dam break."""

    def __init__(self, number, runs):
        self.number = number
        done = [DamBreak(run.folder) for run in runs if run.is_done()]
        self.lost = max((run.summary["particles_lost"] for run in done), default=0)
        self.runs = [run for run in done if not run.has_boiled()]
        self.failures = ([run.failure() for run in runs if run.failure() is not None] +
                         [f"lost {run.summary['particles_lost']} of its particles" for run in done
                          if run.has_boiled()])

    def end(self):
        """End of the shortest repetition [s]."""
        return min((run.end() for run in self.runs), default=0.0)

    @functools.lru_cache(maxsize=None)
    def roughness(self, end, begin=0.4):
        return Estimate([run.roughness(begin, end) for run in self.runs])

    @functools.lru_cache(maxsize=None)
    def peak(self, end, begin=0.4):
        return Estimate([run.peak(begin, end) for run in self.runs])

    @functools.lru_cache(maxsize=None)
    def impulse(self, end):
        return Estimate([run.impulse(0.4, end) for run in self.runs])

    def front_error(self):
        return Estimate([run.front_error() for run in self.runs])

    def delay(self, other):
        """Its delay in T behind another case, from the repetitions with the same Courant number."""
        others = {run.options["courant"]: run for run in other.runs}
        return Estimate([run.behind(others[run.options["courant"]]) for run in self.runs
                         if run.options["courant"] in others])


class Results:
    def __init__(self, study):
        self.study = study

    @functools.lru_cache(maxsize=None)
    def case(self, number):
        return Case(number, self.study.case(number))

    def common_end(self, numbers=CASES):
        """End of the shortest of these cases [s]."""
        return min((self.case(number).end() for number in numbers if self.case(number).runs),
                   default=0.0)

    def tank(self, run):
        """The output of the run, if it is complete."""
        return Tank(run.folder) if run.is_done() else None

    def tanks(self, runs):
        return [tank for run in runs if (tank := self.tank(run)) is not None]

    def map_of(self, name, scheme):
        """A number of the summary over the (a, b) map: rows of a, columns of b; NaN: failed."""
        def number(a, b):
            tank = self.tank(self.study.of_pair(a, b, scheme))
            if tank is None or tank.has_boiled():
                return math.nan
            return tank.summary[name]
        return np.array([[number(a, b) for b in B] for a in A])

    def deviation_map(self, scheme):
        """σ [Pa] over the (a, b) map."""
        return self.map_of("std_over_mean", scheme) * self.map_of("mean", scheme)


class Finding:
    """One of the paper's findings: description, figures of Silt, and whether they reproduce it.
    `sure`: whether the difference exceeds two standard errors; None if there is no error bar."""

    def __init__(self, what, figures, reproduced, sure=None):
        self.what = what
        self.figures = figures
        self.reproduced = reproduced
        self.sure = sure

    def verdict(self):
        if self.reproduced is None:
            return "undetermined"
        if self.sure is False:
            return ("" if self.reproduced else "not ") + "reproduced, within the error bar"
        return "reproduced" if self.reproduced else "**not reproduced**"


def is_below(what, smaller, larger, scale=1.0, unit="", digits=2, factor=1.0):
    """Whether the smaller estimate is below `factor` times the larger one."""
    figures = f"{smaller.text(scale, digits)} against {larger.text(scale, digits)} {unit}".strip()
    if math.isnan(smaller.mean) or math.isnan(larger.mean):
        return Finding(what, figures, None)
    gap = factor * larger.mean - smaller.mean
    error = math.hypot(smaller.error, factor * larger.error)
    return Finding(what, figures, gap > 0, None if math.isnan(error) else abs(gap) > 2 * error)


def of_pressure(results):
    """Figs 12 and 13."""
    def smoother(what, smooth, rough, begin=0.4, factor=1.0):
        cases = [results.case(number) for number in (smooth, rough)]
        end = min(case.end() for case in cases)
        if end < begin:
            failures = [f"case {case.number:02d}: {case.failures[0]}" for case in cases
                        if case.failures]
            return Finding(what, "; ".join(failures) or "not run", None)
        return is_below(f"{what}: case {smooth:02d} against case {rough:02d}",
                        *(case.roughness(end, begin) for case in cases), 1e-3, "kPa",
                        factor=factor)

    def peaks(what, low, high):
        end = results.common_end((low, high))
        return is_below(f"{what}: case {low:02d} against case {high:02d}",
                        results.case(low).peak(end), results.case(high).peak(end), 1e-3, "kPa")

    def improvement(before, after):
        end = results.common_end((before, after))
        return (results.case(before).roughness(end).mean / results.case(after).roughness(end).mean)

    steps = [(0, 1), (1, 3), (3, 4), (4, 5), (5, 9), (9, 10)]
    improvements = {f"{before:02d} to {after:02d}": improvement(before, after)
                    for before, after in steps}
    largest = max(improvements, key=improvements.get)
    return [
        smoother("source (16) gives at most half the roughness of (9)", 1, 0, factor=0.5),
        Finding("the source is the largest single improvement from case 00 to case 10",
                ", ".join(f"{name}: × {value:.2f}" for name, value in improvements.items()),
                largest == "00 to 01"),
        smoother("kernel (3c) gives a smoother pressure than (3a)", 3, 1),
        smoother("kernel (3a) gives a smoother pressure than (3b)", 1, 2),
        smoother("a = 0.8 gives a smoother pressure than 0.5", 4, 3),
        smoother("a = 1.0 gives a smoother pressure than 0.8", 5, 4),
        peaks("a = 0.8 has a lower peak than 0.5", 4, 3),
        peaks("a = 1.0 has a lower peak than 0.8", 5, 4),
        smoother("b = 0.2 gives a smoother pressure than 0.4", 5, 7),
        smoother("b = 0 gives a smoother pressure than 0.4", 6, 7),
        smoother("both conditions of the surface give a smoother pressure than (13)", 9, 5),
        smoother("both conditions of the surface give a smoother pressure than (17)", 9, 8),
        smoother("gradient (18) gives a smoother pressure than (4) at the second and third peaks "
                f"(from {LATER_PEAKS} s)", 10, 9, LATER_PEAKS),
    ]


def of_front(results):
    """Fig. 14."""
    original, adopted = results.case(0), results.case(10)
    delay = adopted.delay(original)
    return [
        Finding("the front of case 10 is slower than that of case 00",
                f"delayed by {delay.text(1, 3)} in T",
                None if math.isnan(delay.mean) else delay.mean > 0,
                None if math.isnan(delay.error) else abs(delay.mean) > 2 * delay.error),
        is_below("case 10 is closer to Martin and Moyce than case 00, rms of Z for T = 1.19–3.3",
                 adopted.front_error(), original.front_error(), 100, "%"),
    ]


def ranks(values):
    """Rank of each value, from 0; equal values get their mean rank."""
    return np.array([np.sum(values < value) + (np.sum(values == value) - 1) / 2
                     for value in values])


def decreases_with_a(deviation, under):
    """Whether σ decreases with a, by their rank correlation over the map: σ of one run has an error
    of some 20 %, so that neighbouring points cannot be compared. Sure if the correlation exceeds
    two standard errors of uncorrelated data, 1/√(n − 1)."""
    # Failed runs count as the roughest; without collisions, b has no effect.
    sigma = np.where(np.isnan(deviation), np.inf, deviation)
    places = [(A[i], sigma[i, j]) for i in range(len(A)) for j in range(len(B))
              if A[i] > 0 or j == 0]
    a, of_a = (np.array(each) for each in zip(*places))
    r = float(np.corrcoef(ranks(a), ranks(of_a))[0, 1])
    medians = ", ".join(f"a = {a:g}: {value:.0f} Pa"
                        for a, value in zip(A, np.median(sigma, axis=1)))
    return Finding(f"RSDR decreases with a, {under}",
                   f"correlation of ranks {r:+.2f} ± {1 / math.sqrt(len(places) - 1):.2f}; medians "
                   f"over b: {medians}", r < 0, abs(r) > 2 / math.sqrt(len(places) - 1))


def of_tank(results, figure):
    """Figs 5, 7, 8 and 9."""
    study = results.study
    found = []
    for scheme in KERNEL_SCHEMES if figure == "fig5" else SCHEMES:
        under = f"else as {scheme}"
        if figure == "fig5":
            tanks = {kernel: results.tanks(study.kernels(kernel, scheme)) for kernel in KERNELS}
            scatter = {kernel: Estimate([tank.summary["std_over_mean"] for tank in of_kernel])
                       for kernel, of_kernel in tanks.items()}
            rough = {kernel: Estimate([tank.roughness(tank.options["statistics_from"])
                                       for tank in of_kernel])
                     for kernel, of_kernel in tanks.items()}
            for other in ("3a", "3b"):
                what = f"kernel (3c) oscillates less than ({other}), {under}"
                found += [is_below(f"{what}: σ over the mean", scatter["3c"], scatter[other], 100,
                                   "%"),
                          is_below(f"{what}: roughness", rough["3c"], rough[other], 1, "Pa", 1)]
        if figure == "fig7":
            rer = results.map_of("rer", scheme)
            near = {(A[i], B[j]): rer[i, j] for i in range(len(A)) for j in range(len(B))
                    if A[i] >= 0.9 and B[j] <= 0.2}
            figures = ", ".join(f"({a:g}, {b:g}): {100 * value:+.2f} %"
                                for (a, b), value in near.items())
            reproduced = all(abs(value) < 0.01 for value in near.values())
            found.append(Finding(f"RER within 1 % for a near 1 and b in 0–0.2, {under}", figures,
                                 reproduced if np.isfinite(list(near.values())).all() else None))
        if figure == "fig8":
            found.append(decreases_with_a(results.deviation_map(scheme), under))
        if figure == "fig9":
            tanks = [results.tanks(study.spacings(l0, scheme)) for l0 in study.spacings_of_study()]
            rer = [Estimate([abs(tank.summary["rer"]) for tank in of_spacing])
                   for of_spacing in tanks]
            slope = [Estimate([tank.line()[0] for tank in of_spacing]) for of_spacing in tanks]
            figures = ", ".join(
                f"l0 = {l0:g} m: {value.text(100)} %"
                for l0, value in zip(study.spacings_of_study(), rer)
            ) + "; slope of the profile over ρ g: " + ", ".join(each.text(1, 3) for each in slope)
            means = [value.mean for value in rer]
            is_known = not any(map(math.isnan, means))
            reproduced = means == sorted(means, reverse=True) if is_known else None
            sure = None
            if reproduced is False:  # whether an increase exceeds two standard errors
                sure = any(after.mean - before.mean >
                           2 * np.nan_to_num(math.hypot(before.error, after.error))
                           for before, after in zip(rer, rer[1:]))
            found.append(Finding(rf"\|RER\| decreases with the spacing, {under}",
                                 figures, reproduced, sure))
    return found


def findings(results, figures):
    """All findings shown by these figures."""
    found = []
    for figure in figures:
        if figure in ("fig5", "fig7", "fig8", "fig9"):
            found += of_tank(results, figure)
        elif figure == "fig12":
            found += of_pressure(results)
        elif figure == "fig14":
            found += of_front(results)
    return found
