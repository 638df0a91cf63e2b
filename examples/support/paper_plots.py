# SPDX-License-Identifier: MIT
"""Draws the figures of [HwangLeePark2010] from the runs of support/paper_study.py."""

from support import plot_style as style
from support.paper_study import A, B, CASES, KERNEL_SCHEMES, KERNELS, SCHEMES
from support.plot_style import BLUE, CURVES, DARK, DASHED, ORANGE, np, plt
from support.water import DENSITY, FRONT, G, REFERENCE, moving_average, name_of, table

# Captions of the schemes of the hydrostatic study.
SCHEME_NAMES = {"case 10": "as in Case 10 (PNU-MPS)",
                "case 05": "as in Case 05 (surface (13), gradient (4))",
                "cases 01–03": "as in Cases 01–03 (a = 0.5, surface (13), gradient (4))"}

# The cases shown together in Fig. 12, and the changes between them.
GROUPS = (("source term", {0: "(9)", 1: "(16)"}),
          ("kernel", {1: "(3a)", 2: "(3b)", 3: "(3c)"}),
          ("distance a of collisions", {3: "0.5", 4: "0.8", 5: "1.0"}),
          ("restitution b of collisions", {5: "0.2", 6: "0", 7: "0.4"}),
          ("surface condition", {5: "(13)", 8: "(17)", 9: "both"}),
          ("pressure gradient", {9: "(4)", 10: "(18)"}))


def draw_kernels(results):
    """Fig. 5: P1 over time for the three kernels."""
    figure, panels = plt.subplots(len(KERNELS), len(KERNEL_SCHEMES), figsize=(style.WIDE, 7),
                                  sharex=True, sharey=True, squeeze=False)
    for row, kernel in zip(panels, KERNELS):
        for axes, scheme, colour in zip(row, KERNEL_SCHEMES, CURVES):
            run = results.study.kernels(kernel, scheme)[0]
            tank = results.tank(run)
            if tank is None:
                axes.set_title(f"kernel ({kernel}): failed")
                continue
            axes.plot(tank.pressure["t"], tank.pressure["p_1"] / 1e3, linewidth=0.6, color=colour)
            axes.axhline(tank.summary["analytic"] / 1e3, color=DARK, linewidth=1,
                         linestyle=DASHED, zorder=3)
            axes.set_title(f"kernel ({kernel}): RER {100 * tank.summary['rer']:+.2f} %, σ/mean "
                           f"{100 * tank.summary['std_over_mean']:.2f} %")
    for axes, scheme in zip(panels[0], KERNEL_SCHEMES):
        name = SCHEME_NAMES[scheme].replace(" (", "\n(", 1)
        axes.set_title(f"All else {name}\n\n{axes.get_title('left')}")
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    figure.supylabel("pressure at gauge P1 [kPa]; dashed: ρ g h", fontsize=10)
    return figure


def draw_map(values_of, label, norm, colours, text):
    figure, panels = plt.subplots(1, len(SCHEMES), figsize=(style.WIDE, 4.4))
    shown = []
    for axes, scheme in zip(panels, SCHEMES):
        values = values_of(scheme)
        image = axes.imshow(values, origin="lower", aspect="auto", cmap=colours, norm=norm)
        axes.set_facecolor("#c4c4c4")
        for (i, j), value in np.ndenumerate(values):
            is_dark = not np.isnan(value) and sum(image.cmap(norm(value))[:3]) < 1.5
            axes.text(j, i, "failed" if np.isnan(value) else text(value), ha="center", va="center",
                      fontsize=8, color="white" if is_dark else DARK)
        axes.set_xticks(range(len(B)), [f"{b:g}" for b in B])
        axes.set_yticks(range(len(A)), [f"{a:g}" for a in A])
        axes.set_xlabel("restitution b [-]")
        axes.set_ylabel("distance a [spacings]")
        axes.set_title("All else " + SCHEME_NAMES[scheme].replace(" (", "\n(", 1))
        axes.grid(False)
        shown.append(values[np.isfinite(values)])
    style.bar_of(figure, image, panels, label, shown)
    return figure


def draw_errors(results):
    """Fig. 7: RER over the (a, b) plane."""
    maps = {scheme: 100 * results.map_of("rer", scheme) for scheme in SCHEMES}
    most = np.ceil(max(np.nanmax(np.abs(values)) for values in maps.values()))
    return draw_map(maps.get, "relative error RER of the mean pressure [%]", plt.Normalize(-most, most),
                    "PuOr", lambda value: f"{value:+.2f}")


def draw_deviations(results):
    """Fig. 8: RSDR over the (a, b) plane."""
    def relative(scheme):
        deviation = results.deviation_map(scheme)
        return deviation / np.nanmax(deviation)
    return draw_map(relative, "standard deviation RSDR = σ/σ$_{max}$ [-]", plt.Normalize(0, 1),
                    "cividis_r", lambda value: f"{value:.3f}")


def draw_spacings(results):
    """Fig. 9: P1 and RER for the spacings."""
    study = results.study
    adopted = next(iter(SCHEMES))
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.WIDE, 4.2))
    for l0 in study.spacings_of_study():
        if tanks := results.tanks(study.spacings(l0, adopted)[:1]):
            pressure = tanks[0].pressure
            left.plot(pressure["t"], moving_average(pressure["t"], pressure["p_1"]) / 1e3,
                      linewidth=0.9, label=f"l0 = {l0:g} m")
    left.axhline(DENSITY * G * 0.4 / 1e3, color=DARK, linewidth=1, linestyle=DASHED,
                 label="ρ g h")
    left.set_xlabel("time [s]")
    left.set_ylabel("pressure at gauge P1, averaged over 0.02 s [kPa]")
    style.legend_on_top(left, 2, "all else " + SCHEME_NAMES[adopted])
    for scheme, colour in zip(SCHEMES, CURVES):
        for l0 in study.spacings_of_study():
            for tank in results.tanks(study.spacings(l0, scheme)):
                right.plot(l0, 100 * tank.summary["rer"], "o", markersize=4, color=colour)
        right.plot([], [], "o", color=colour, label="all else " + SCHEME_NAMES[scheme])
    right.axhline(0, color=DARK, linewidth=1)
    right.set_xlabel("spacing [m]")
    right.set_ylabel("relative error RER of the mean [%]")
    right.set_xlim(0, 0.022)
    right.set_xticks(study.spacings_of_study())
    style.legend_on_top(right, 1)
    return figure


def draw_pressure(axes, case, colour, label, linewidth=0.5):
    if not case.runs:
        return
    run = case.runs[0]
    axes.plot(run.pressure["t"], run.pressure["p_1"] / 1e3, color=colour, linewidth=linewidth,
              label=label)


def leave_out_spikes(axes, cases):
    """Limits the pressure axis if single values far exceed all others, and says where they are."""
    limit, spike = 0.0, (0.0, 0.0)
    for case in cases:
        if not case.runs:
            continue
        pressure = case.runs[0].pressure
        shown = pressure["t"] > axes.get_xlim()[0]
        t, p = pressure["t"][shown], pressure["p_1"][shown] / 1e3
        intervals = np.unique((t / 0.02).astype(int), return_inverse=True)[1]
        peaks = [p[intervals == k].max() for k in range(intervals.max() + 1)]
        limit = max(limit, float(np.quantile(peaks, 0.9)))
        spike = max(spike, (float(p.max()), float(t[p.argmax()])))
    if spike[0] > 20 * limit:
        axes.set_ylim(0, 2 * limit)
        axes.text(0.98, 0.96, f"beyond the axis: up to {spike[0]:.0f} kPa at t = {spike[1]:.2f} s",
                  transform=axes.transAxes, ha="right", va="top", fontsize=9,
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})


def draw_groups(results):
    """Fig. 12: P2 over time, group by group."""
    figure, panels = plt.subplots(3, 2, figsize=(style.WIDE, 9.5), sharex=True)
    end = results.common_end()
    for axes, (what, cases) in zip(panels.flat, GROUPS):
        # The roughest curve is drawn first.
        order = sorted(cases, key=lambda number: -results.case(number).roughness(end).mean)
        for number in order:
            case = results.case(number)
            rough = case.roughness(end).text(1e-3)
            draw_pressure(axes, case, CURVES[list(cases).index(number)],
                          f"{cases[number]}, {name_of(number)}: {rough} kPa")
        style.legend_on_top(axes, 1, what)
        axes.set_xlim(0.3, end)
        axes.set_ylim(0)
        leave_out_spikes(axes, [results.case(number) for number in cases])
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    for axes in panels[:, 0]:
        axes.set_ylabel("pressure at gauge P2 [kPa]")
    figure.suptitle(f"What changes between the cases, and the roughness of each, 0.4–{end:.1f} s",
                    x=0.01, ha="left")
    return figure


def draw_original_and_adopted(results):
    """Fig. 13: P2 of case 00 and case 10, and the roughness of all cases."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.WIDE, 4.2), width_ratios=(2, 1))
    end = results.common_end()
    draw_pressure(left, results.case(0), ORANGE, name_of(0))
    draw_pressure(left, results.case(10), BLUE, name_of(10), 0.7)
    left.set_xlim(0.3, end)
    left.set_ylim(0)
    leave_out_spikes(left, [results.case(0), results.case(10)])
    left.set_xlabel("time [s]")
    left.set_ylabel("pressure at gauge P2 [kPa]")
    style.legend_on_top(left)
    for number in CASES:
        values = np.array(results.case(number).roughness(end).values) / 1e3
        right.plot(np.full(len(values), number), values, "o", markersize=3.5,
                   color=ORANGE if number == 0 else BLUE)
    right.set_yscale("log")
    right.minorticks_off()
    ticks = np.array([0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000])
    low, high = right.get_ylim()
    ticks = ticks[(ticks >= low) & (ticks <= high)]
    right.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    right.set_xticks(CASES, [f"{number:02d}" for number in CASES])
    right.set_xlabel("case")
    right.set_ylabel("roughness at gauge P2 [kPa]")
    right.set_title(f"every run, 0.4–{end:.1f} s")
    return figure


def draw_fronts(results):
    """Fig. 14: the leading edge of case 00 and case 10, compared with the experiment."""
    figure, axes = plt.subplots(figsize=(style.NARROW, 4.6))
    for number, colour in ((0, ORANGE), (10, BLUE)):
        case = results.case(number)
        for k, run in enumerate(case.runs):
            T, Z = run.dimensionless_front()
            shift = run.time_shift() or 0
            label = (f"{name_of(number)}: rms {case.front_error().text(100, 1)} %, shifted by "
                     f"{shift:.2f} in T")
            before = run.before_the_wall()
            axes.plot(T[before] + shift, Z[before], color=colour, linewidth=1, alpha=0.8,
                      label=label if k == 0 else None)
    experiment = table(REFERENCE / FRONT)
    axes.plot(experiment["T"], experiment["Z"], "o", color=DARK, markersize=4.5,
              label="Martin & Moyce (1952), experiment")
    axes.set_xlim(0)
    axes.set_xlabel("T = t √(2g/a) [-]")
    axes.set_ylabel("leading edge Z = x/a [-]")
    style.legend_on_top(axes, 1)
    return figure


DRAW = {"fig5": draw_kernels, "fig7": draw_errors, "fig8": draw_deviations, "fig9": draw_spacings,
        "fig12": draw_groups, "fig13": draw_original_and_adopted, "fig14": draw_fronts}
