# SPDX-License-Identifier: MIT
"""Draws the figures of [HwangLeePark2010] from the runs of support/paper_study.py."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from support.paper_study import A, B, CASES, KERNEL_SCHEMES, KERNELS, SCHEMES
from support.water import (BLUE, DARK, DENSITY, FRONT, G, GREEN, ORANGE, REFERENCE, moving_average,
                           table, tidy)

COLOURS = (BLUE, ORANGE, GREEN)
# The cases side by side in Fig. 12, and what changes between them.
GROUPS = (("source (9) and (16)", (0, 1)), ("kernel (3a), (3b), (3c)", (1, 2, 3)),
          ("a = 0.5, 0.8, 1.0", (3, 4, 5)), ("b = 0.2, 0, 0.4", (5, 6, 7)),
          ("surface (13), (17), both", (5, 8, 9)), ("gradient (4) and (18)", (9, 10)))


def save(figure, path):
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_kernels(results, path):
    """Fig. 5: P1 over time for the three kernels."""
    figure, panels = plt.subplots(len(KERNELS), len(KERNEL_SCHEMES), figsize=(10.5, 6.2), sharex=True,
                                  sharey=True, layout="constrained", squeeze=False)
    for row, kernel in zip(panels, KERNELS):
        for axes, scheme, colour in zip(row, KERNEL_SCHEMES, COLOURS):
            run = results.study.kernels(kernel, scheme)[0]
            title = f"kernel ({kernel}), else as {scheme}"
            tank = results.tank(run)
            if tank is None:
                axes.set_title(f"{title}: failed", loc="left", fontsize=9)
                continue
            axes.axhline(tank.summary["analytic"] / 1e3, color=DARK, linewidth=1,
                         linestyle=(0, (4, 3)))
            axes.plot(tank.pressure["t"], tank.pressure["p_1"] / 1e3, linewidth=0.6, color=colour)
            axes.set_title(f"{title}: RER {100 * tank.summary['rer']:+.2f} %, σ "
                           f"{100 * tank.summary['std_over_mean']:.2f} %", loc="left", fontsize=9)
            axes.set_ylim(2.5, 5.5)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    panels[1, 0].set_ylabel("pressure at P1 [kPa]")
    tidy(panels.flat)
    save(figure, path)


def draw_map(values_of, label, norm, colours, path, text):
    figure, panels = plt.subplots(1, len(SCHEMES), figsize=(10.5, 4.4), layout="constrained")
    for axes, scheme in zip(panels, SCHEMES):
        values = values_of(scheme)
        image = axes.imshow(values, origin="lower", aspect="auto", cmap=colours, norm=norm)
        axes.set_facecolor("#d9d9d9")
        for (i, j), value in np.ndenumerate(values):
            is_dark = not np.isnan(value) and sum(image.cmap(norm(value))[:3]) < 1.5
            axes.text(j, i, "failed" if np.isnan(value) else text(value), ha="center", va="center",
                      fontsize=8, color="white" if is_dark else DARK)
        axes.set_xticks(range(len(B)), [f"{b:g}" for b in B])
        axes.set_yticks(range(len(A)), [f"{a:g}" for a in A])
        axes.set_xlabel("b")
        axes.set_ylabel("a")
        axes.set_title(f"else as {scheme}", loc="left", fontsize=10)
    figure.colorbar(image, ax=panels, label=label, extend="both")
    save(figure, path)


def draw_errors(results, path):
    """Fig. 7: RER over the (a, b) plane."""
    draw_map(lambda scheme: 100 * results.map_of("rer", scheme), "RER [%]", Normalize(-6, 6),
             "RdBu_r", path, lambda value: f"{value:+.2f}")


def draw_deviations(results, path):
    """Fig. 8: RSDR over the (a, b) plane."""
    def relative(scheme):
        deviation = results.deviation_map(scheme)
        return deviation / np.nanmax(deviation)
    draw_map(relative, "RSDR = σ/σ_max", Normalize(0, 1), "YlOrRd", path,
             lambda value: f"{value:.3f}")


def draw_spacings(results, path):
    """Fig. 9: P1 and RER for the spacings."""
    study = results.study
    adopted = next(iter(SCHEMES))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), layout="constrained")
    for l0 in study.spacings_of_study():
        if tanks := results.tanks(study.spacings(l0, adopted)[:1]):
            pressure = tanks[0].pressure
            left.plot(pressure["t"], moving_average(pressure["t"], pressure["p_1"]) / 1e3,
                      linewidth=0.9, label=f"l0 = {l0:g} m")
    left.axhline(DENSITY * G * 0.4 / 1e3, color=DARK, linewidth=1, linestyle=(0, (4, 3)))
    left.set_ylim(3, 5)
    left.set_xlabel("time [s]")
    left.set_ylabel("pressure at P1, averaged over 0.02 s [kPa]")
    left.set_title(adopted, loc="left", fontsize=10)
    left.legend(frameon=False, fontsize=9, loc="lower right")
    for scheme, colour in zip(SCHEMES, COLOURS):
        for l0 in study.spacings_of_study():
            for tank in results.tanks(study.spacings(l0, scheme)):
                right.plot(l0, 100 * tank.summary["rer"], "o", markersize=4, color=colour)
        right.plot([], [], "o", color=colour, label=f"else as {scheme}")
    right.axhline(0, color=DARK, linewidth=1)
    right.set_xlabel("spacing [m]")
    right.set_ylabel("RER [%]")
    right.set_xlim(0, 0.022)
    right.set_xticks(study.spacings_of_study())
    right.legend(frameon=False, fontsize=9)
    tidy((left, right))
    save(figure, path)


def draw_pressure(axes, case, colour, label, linewidth=0.5):
    if not case.runs:
        return
    run = case.runs[0]
    axes.plot(run.pressure["t"], run.pressure["p_1"] / 1e3, color=colour, linewidth=linewidth,
              label=label)


def draw_groups(results, path):
    """Fig. 12: P2 over time, group by group."""
    figure, panels = plt.subplots(3, 2, figsize=(11.5, 9), sharex=True, sharey=True,
                                  layout="constrained")
    end = results.common_end()
    for axes, (what, cases) in zip(panels.flat, GROUPS):
        # The roughest below the others.
        order = sorted(cases, key=lambda number: -results.case(number).roughness(end).mean)
        for number in order:
            case = results.case(number)
            rough = case.roughness(end).text(1e-3)
            draw_pressure(axes, case, COLOURS[cases.index(number)],
                          f"case {number:02d}: {rough} kPa")
        axes.set_title(what, loc="left", fontsize=10)
        axes.legend(frameon=False, fontsize=8, title=f"roughness, 0.4–{end:.1f} s",
                    title_fontsize=8)
    axes.set_xlim(0.3, end)
    axes.set_ylim(0, 45)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    for axes in panels[:, 0]:
        axes.set_ylabel("pressure at P2 [kPa]")
    tidy(panels.flat)
    save(figure, path)


def draw_original_and_adopted(results, path):
    """Fig. 13: P2 of case 00 and case 10; beside it the roughness of all cases."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.5, 4.2), width_ratios=(2, 1),
                                         layout="constrained")
    end = results.common_end()
    draw_pressure(left, results.case(0), ORANGE, "case 00, the original MPS")
    draw_pressure(left, results.case(10), BLUE, "case 10, PNU-MPS", 0.7)
    left.set_xlim(0.3, end)
    left.set_ylim(0, 60)
    left.set_xlabel("time [s]")
    left.set_ylabel("pressure at P2 [kPa]")
    left.legend(frameon=False, fontsize=9)
    for number in CASES:
        values = np.array(results.case(number).roughness(end).values) / 1e3
        right.plot(np.full(len(values), number), values, "o", markersize=3.5,
                   color=ORANGE if number == 0 else BLUE)
    right.set_yscale("log")
    right.set_xticks(CASES, [f"{number:02d}" for number in CASES])
    right.set_xlabel("case")
    right.set_ylabel("roughness at P2 [kPa]")
    right.set_title(f"every run, 0.4–{end:.1f} s", loc="left", fontsize=10)
    tidy((left, right))
    save(figure, path)


def draw_fronts(results, path):
    """Fig. 14: the leading edge of case 00 and case 10 against the experiment."""
    figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
    for number, colour, name in ((0, ORANGE, "case 00"), (10, BLUE, "case 10, PNU-MPS")):
        case = results.case(number)
        for k, run in enumerate(case.runs):
            T, Z = run.dimensionless_front()
            shift = run.time_shift() or 0
            label = f"{name}: rms {case.front_error().text(100, 1)} %, shifted by {shift:.2f}"
            axes.plot(T + shift, Z, color=colour, linewidth=1, alpha=0.8,
                      label=label if k == 0 else None)
    experiment = table(REFERENCE / FRONT)
    axes.plot(experiment["T"], experiment["Z"], "o", color=DARK, markersize=4.5,
              label="Martin & Moyce 1952, n² = 2")
    axes.set_xlim(0, 3.6)
    axes.set_ylim(0.9, 4.1)
    axes.set_xlabel("T = t √(2g/a)")
    axes.set_ylabel("Z = x/a")
    axes.legend(frameon=False, fontsize=9)
    tidy([axes])
    save(figure, path)


DRAW = {"fig5": draw_kernels, "fig7": draw_errors, "fig8": draw_deviations, "fig9": draw_spacings,
        "fig12": draw_groups, "fig13": draw_original_and_adopted, "fig14": draw_fronts}
