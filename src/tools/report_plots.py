# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the report. Colours by M. Okabe and K. Ito, which people with any kind of colour vision tell apart; each line or
point has a marker of its own too."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, NullFormatter  # noqa: E402

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
# 8 x 5 inches at 110 dots: 880 pixels wide, still readable at 800.
SIZE, DPI = (8.0, 5.0), 110

plt.rcParams.update({"font.size": 11, "axes.grid": True, "grid.alpha": 0.35, "axes.spines.top": False,
                     "axes.spines.right": False, "legend.frameon": False})


def _style(index):
    return {"color": COLOURS[index % len(COLOURS)], "marker": MARKERS[index % len(MARKERS)]}


def _save(figure, path):
    figure.savefig(path, dpi=DPI)
    plt.close(figure)


def _plain_logarithmic(axis):
    """1, 10, 100 and 0.1 instead of powers of ten, and labels between them where few decades are shown."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    low, high = axis.get_view_interval()
    digits = "23456789" if high / low < 8 else "25" if high / low < 100 else ""
    if digits:
        axis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in digits else ""))
    else:
        axis.set_minor_formatter(NullFormatter())
    for label in axis.get_minorticklabels():
        label.set_fontsize(9.5)


def _logarithmic(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.08)
    _plain_logarithmic(axes.xaxis)
    _plain_logarithmic(axes.yaxis)


def _unique(rows, key):
    return list(dict.fromkeys(row[key] for row in rows))


def _front(points):
    """Those of the points (cost, error) that no other one beats in both, by cost."""
    return sorted(point for point in points
                  if not any(other != point and other[0] <= point[0] and other[1] <= point[1] for other in points))


def formulations(rows, path):
    """Two errors against two costs: energy norm over matrix creation, tip of the beam over a step."""
    rows = [row for row in rows if "formulation" in row]
    if not rows:
        return False
    names, meshes = _unique(rows, "formulation"), _unique(rows, "mesh")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 6.2))
    for name in names:
        for mesh in meshes:
            series = [row for row in rows if row["formulation"] == name and row["mesh"] == mesh]
            if not series:
                continue
            style = {"color": COLOURS[names.index(name) % len(COLOURS)], "marker": MARKERS[meshes.index(mesh) % len(MARKERS)],
                     "markersize": 7, "alpha": 0.85, "markeredgewidth": 0}
            left.plot(series[-1]["matrix_us_per_cell"], 100 * series[-1]["energy_error"], **style)
            right.plot([row["step_ms"] for row in series], [100 * abs(row["tip_error"]) for row in series],
                       linestyle=":", linewidth=0.8, **style)
    # Uncorrected quadrature fails the patch test, so it is no choice.
    front = _front([(row["step_ms"], 100 * abs(row["tip_error"])) for row in rows
                    if "uncorrected" not in row["formulation"]])
    right.plot(*zip(*front), color="black", linewidth=1.2, linestyle="--", zorder=0)
    left.set_xlabel("matrix creation [µs a cell]")
    left.set_ylabel("error in the energy norm, finest cube [%]")
    right.set_xlabel("time step of the beam, all sizes [ms]")
    right.set_ylabel("error of the beam's tip, nu = 0.3 [%]")
    _logarithmic(right)
    left.set_xscale("log")
    left.margins(0.1)
    left.set_ylim(bottom=0)
    _plain_logarithmic(left.xaxis)
    by_colour = [plt.Line2D([], [], color=COLOURS[i % len(COLOURS)], marker="o", linestyle="", label=name)
                 for i, name in enumerate(names)]
    by_marker = [plt.Line2D([], [], color="#666666", marker=MARKERS[i % len(MARKERS)], linestyle="", label=name)
                 for i, name in enumerate(meshes)]
    by_marker.append(plt.Line2D([], [], color="black", linestyle="--", linewidth=1.2, label="none beats these in both"))
    figure.legend(handles=by_colour, loc="lower left", bbox_to_anchor=(0.06, 0.0), fontsize=10)
    figure.legend(handles=by_marker, loc="lower left", bbox_to_anchor=(0.58, 0.0), fontsize=10)
    figure.tight_layout(rect=(0, 0.25, 1, 1))
    _save(figure, path)
    return True


def _bars(axes, index, at, values, label):
    """The bars of one of three methods, side by side around each place."""
    return axes.bar([place + 0.27 * (index - 1) for place in at], values, 0.25, color=COLOURS[index], label=label,
                    hatch=["", "//", ".."][index], edgecolor="white")


def cutting(rows, path):
    """Bars a body: what the same cut costs as polyhedra and as tetrahedra."""
    rows = [row for row in rows if "sag_error" in row]
    if not rows:
        return False
    quantities = [("cells", 1, "cells"), ("sag_error", 100, "error of the static sag [%]"),
                  ("condition", 1, "condition number"),
                  ("stable_step_with_mass_floor_s", 1e3, "stable explicit step [ms]"),
                  ("step_ms", 1, "implicit step [ms]"), ("unknowns", 1, "unknowns")]
    bodies, methods = _unique(rows, "body"), _unique(rows, "method")
    figure, grid = plt.subplots(2, 3, figsize=(8.0, 6.0))
    for axes, (key, scale, label) in zip(grid.flat, quantities):
        for i, method in enumerate(methods):
            of_method = [row for row in rows if row["method"] == method]
            at = [bodies.index(row["body"]) for row in of_method]
            values = [scale * abs(row[key]) for row in of_method]
            _bars(axes, i, at, values, method)
        axes.set_xticks(range(len(bodies)), bodies)
        axes.set_title(label, fontsize=10.5)
        axes.set_yscale("linear" if key == "sag_error" else "log")
        axes.grid(axis="x", visible=False)
        axes.tick_params(labelsize=9.5)
    handles, labels = grid.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=3, fontsize=10)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    _save(figure, path)
    return True


def cell_counts(rows, path):
    """Cells against re-tessellated ones, and the cells by their number of vertices."""
    rows = [row for row in rows if "times_fewest" in row]
    if not rows:
        return False
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 5.0))
    names = [f"{row['body']}, {row['blades'].split(',')[0]}".replace(" bent", "\nbent") for row in rows]
    counts = [("cells", "polyhedra"), ("tetrahedra_fewest", "tetrahedra, fewest"),
              ("tetrahedra_with_middles", "tetrahedra, with middles")]
    for i, (key, label) in enumerate(counts):
        bars = _bars(left, i, range(len(rows)), [row[key] for row in rows], label)
        if i > 0:
            left.bar_label(bars, [f"{row[key] / row['cells']:.1f}x" for row in rows], fontsize=9, rotation=90, padding=2)
    left.set_xticks(range(len(rows)), names, rotation=35, ha="right", fontsize=9.5)
    left.set_ylabel("cells")
    left.margins(y=0.12)
    left.grid(axis="x", visible=False)
    left.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    left.tick_params(axis="y", labelsize=9.5)
    vertices = [*range(4, 13), "more"]
    for i, row in enumerate(rows):
        parts = [100 * row[f"cells_of_{n}_vertices"] / row["cells"] for n in vertices]
        right.plot(range(len(vertices)), parts, label=names[i].replace("\n", " "), **_style(i))
    right.set_xticks(range(len(vertices)), vertices)
    right.set_xlabel("vertices of a cell")
    right.set_ylabel("part of the cells [%]")
    right.legend(fontsize=9.5)
    figure.legend(*left.get_legend_handles_labels(), loc="lower center", ncol=3, fontsize=10)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    _save(figure, path)
    return True


def integration(rows, path):
    rows = [row for row in rows if "error_after_1_s" in row]
    if not rows:
        return False
    figure, axes = plt.subplots(figsize=SIZE)
    for i, solver in enumerate(_unique(rows, "solver")):
        of_solver = [row for row in rows if row["solver"] == solver]
        axes.plot([row["wall_ms_per_simulated_s"] for row in of_solver], [100 * row["error_after_1_s"] for row in of_solver],
                  label=solver, **_style(i))
        for row in of_solver if i == 0 else []:  # the others' points lie at the same heights
            axes.annotate(f"h = {1e3 * row['time_step_s']:g} ms",
                          (row["wall_ms_per_simulated_s"], 100 * row["error_after_1_s"]), xytext=(6, 5),
                          textcoords="offset points", fontsize=10)
    _logarithmic(axes)
    axes.legend(title="solver")
    axes.set_xlabel("wall time of one simulated second [ms]")
    axes.set_ylabel("error of the positions after 1 s [%]")
    axes.margins(0.14)
    figure.tight_layout()
    _save(figure, path)
    return True


STAGES = [("assembly_ms", "assembly"), ("solve_ms", "solution"), ("detection_ms", "contact detection"),
          ("contact_ms", "contact forces"), ("cutting_ms", "cutting"), ("update_ms", "update after cuts"),
          ("other_ms", "stress and the rest")]


def stages(rows, path):
    rows = [row for row in rows if "scene" in row]
    if not rows:
        return False
    figure, axes = plt.subplots(figsize=SIZE)
    names = [row["scene"] for row in rows]
    start = [0.0] * len(rows)
    for i, (key, label) in enumerate(STAGES):
        widths = [max(0.0, row[key]) for row in rows]
        axes.barh(names, widths, left=start, color=COLOURS[i], label=label, hatch=["", "", "//", "", "..", "", "xx"][i],
                  edgecolor="white", linewidth=0.5)
        start = [a + b for a, b in zip(start, widths)]
    for i, total in enumerate(start):
        axes.annotate(f"{total:.3g} ms", (total, i), xytext=(4, 0), textcoords="offset points", va="center", fontsize=10)
    axes.invert_yaxis()
    axes.margins(x=0.12)
    axes.set_xlabel("mean time of a step [ms]")
    axes.grid(axis="y", visible=False)
    figure.legend(loc="lower center", ncol=4, fontsize=10)
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    _save(figure, path)
    return True


def peers(rows, path):
    rows = [row for row in rows if "motion_error" in row]
    if not rows:
        return False
    bodies = _unique(rows, "body")
    figure, all_axes = plt.subplots(1, len(bodies), figsize=(8.0, 5.2), squeeze=False, sharex=True, sharey=True)
    for axes, body in zip(all_axes[0], bodies):
        of_body = [row for row in rows if row["body"] == body]
        series = {}
        for row in of_body:
            series.setdefault(_peer(row), []).append(row)
        for key, of_series in series.items():
            index = _legend_index(rows, key)
            axes.plot([1e-3 * row["wall_ms_per_simulated_s"] for row in of_series],
                      [100 * row["motion_error"] for row in of_series], label=key,
                      linestyle="-" if len(of_series) > 1 else "", **_style(index))
        _logarithmic(axes)
        axes.set_title(body, fontsize=10.5)
        axes.set_xlabel("wall time of 1 s [s]" if len(bodies) > 1 else "wall time of one simulated second [s]")
        axes.tick_params(labelsize=9.5)
    all_axes[0][0].set_ylabel("error of the motion [%]")
    handles, labels = [], []
    for axes in all_axes[0]:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            if label not in labels:
                handles.append(handle)
                labels.append(label)
    figure.legend(handles, labels, loc="lower left", bbox_to_anchor=(0.04, 0), fontsize=9)
    figure.tight_layout(rect=(0, 0.02 + 0.042 * len(labels), 1, 1))
    _save(figure, path)
    return True


def _peer(row):
    return f"{row['peer'].split(',')[0]}: {row['settings']}"


def _legend_index(rows, key):
    keys = list(dict.fromkeys(_peer(row) for row in sorted(rows, key=lambda row: row["peer"] != "polyscalpel")))
    return keys.index(key)


def solvers(rows, path):
    """Time of a step against the error at the gate, a panel a body."""
    rows = [row for row in rows if row.get("gate_error") and "step_ms" in row]
    if not rows:
        return False
    bodies, names = _unique(rows, "body"), list(dict.fromkeys(_solver(row) for row in rows))
    columns = min(2, len(bodies))
    figure, grid = plt.subplots(-(-len(bodies) // columns), columns, figsize=(8.0, 7.0), squeeze=False)
    for axes in grid.flat[len(bodies):]:
        axes.set_visible(False)
    for axes, body in zip(grid.flat, bodies):
        for row in rows:
            if row["body"] == body:
                axes.plot(row["step_ms"], 100 * row["gate_error"], linestyle="", markersize=8,
                          **_style(names.index(_solver(row))))
        axes.axhline(1e-2, color="black", linestyle="--", linewidth=1)
        _logarithmic(axes)
        axes.set_title(body, fontsize=10.5)
        axes.set_xlabel("a step [ms]")
        axes.set_ylabel("error of the displacement [%]")
        axes.tick_params(labelsize=9.5)
    handles = [plt.Line2D([], [], linestyle="", label=name, **_style(i)) for i, name in enumerate(names)]
    handles.append(plt.Line2D([], [], color="black", linestyle="--", linewidth=1, label="what is held: 0.01 %"))
    figure.legend(handles=handles, loc="lower center", ncol=4, fontsize=10)
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    _save(figure, path)
    return True


def _solver(row):
    return row["solver"] if row["threads"] == 1 else f"{row['solver']}, {row['threads']} threads"


def scaling(rows, path):
    """Time of a step and memory against cells."""
    exponents = {row["family"]: row["exponent"] for row in rows if "exponent" in row}
    rows = [row for row in rows if "step_ms" in row]
    if not rows:
        return False
    figure, all_axes = plt.subplots(1, 2, figsize=SIZE)
    series = {}
    for row in rows:
        series.setdefault((row["family"], row["solver"]), []).append(row)
    for i, ((family, solver), of_series) in enumerate(series.items()):
        label = f"{family}, {solver}"
        if solver == "auto" and family in exponents:
            label += f": exponent {exponents[family]:.2f}"
        cells = [row["cells"] for row in of_series]
        for axes, key in zip(all_axes, ["step_ms", "memory_mb"]):
            axes.plot(cells, [row[key] for row in of_series], label=label, linestyle="-", **_style(i))
    for axes, heading in zip(all_axes, ["a step [ms]", "memory held [MB]"]):
        _logarithmic(axes)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("tetrahedra")
        axes.set_ylabel(heading)
    figure.legend(*all_axes[0].get_legend_handles_labels(), loc="lower center", ncol=2, fontsize=10)
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    _save(figure, path)
    return True


def after_cuts(rows, path):
    """Bars a method: what a step of the cut body costs, beside cells and unknowns."""
    rows = [row for row in rows if "step_ms" in row and row["threads"] == 1]
    if not rows:
        return False
    bodies, methods = _unique(rows, "body"), list(dict.fromkeys(_method(row) for row in rows))
    quantities = [("cells", "cells"), ("unknowns", "unknowns"), ("steps_per_s", "steps a second")]
    figure, all_axes = plt.subplots(1, len(quantities), figsize=(8.0, 4.6))
    for axes, (key, heading) in zip(all_axes, quantities):
        for i, method in enumerate(methods):
            of_method = [row for row in rows if _method(row) == method]
            bars = _bars(axes, i, [bodies.index(row["body"]) for row in of_method], [row[key] for row in of_method], method)
            axes.bar_label(bars, [f"{row[key]:,.3g}" if row[key] < 1000 else f"{row[key]:,.0f}" for row in of_method],
                           fontsize=8.5, rotation=90, padding=2)
        axes.set_xticks(range(len(bodies)), [body.replace(", ", ",\n") for body in bodies])
        axes.set_title(heading, fontsize=10.5)
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
        axes.margins(y=0.25)
        axes.grid(axis="x", visible=False)
        axes.tick_params(labelsize=9.5)
    figure.legend(*all_axes[0].get_legend_handles_labels(), loc="lower center", ncol=3, fontsize=10)
    figure.tight_layout(rect=(0, 0.09, 1, 1))
    _save(figure, path)
    return True


def _method(row):
    return f"{row['method']}: {row['solver']}"


PLOTS = {"formulations": formulations, "cutting": cutting, "cell_counts": cell_counts, "integration": integration,
         "stages": stages, "peers": peers, "solvers": solvers, "scaling": scaling, "after_cuts": after_cuts}
