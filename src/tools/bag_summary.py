#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a recorded bag tells of a simulation: bag_summary.py demo.bag [--output summary.json]."""

import argparse
import json
import math
import os
import sys

import rosbag


class SummaryError(Exception):
    """The bag does not hold what a summary needs."""


def quantile(values, q):
    """The value at or below which a part q of the values lies (nearest rank)."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(q * len(ordered)) - 1)]


def read(path):
    """Messages of status, cut_events and all wrenches, each in the order of the bag."""
    statuses, cuts, forces, mesh_count = [], [], [], 0
    with rosbag.Bag(path) as bag:
        for topic, message, stamp in bag.read_messages():
            name = topic.rpartition("/")[2]
            if name == "status":
                statuses.append((stamp.to_sec(), message))
            elif name == "cut_events":
                cuts.append(message)
            elif name == "measured_cf":
                force = message.wrench.force
                forces.append(math.sqrt(force.x**2 + force.y**2 + force.z**2))
            elif name == "mesh":
                mesh_count += 1
    if not statuses or not forces or mesh_count == 0:
        raise SummaryError(f"{path} holds {len(statuses)} status, {len(forces)} wrench and {mesh_count} mesh messages; "
                           "each must be there")
    return statuses, cuts, forces


STAGES = ("detection", "contact", "assembly", "solve", "cutting", "update")
AROUND = 50  # steps before the first cut and after the last one


def stages_ms(steps, cuts):
    """Medians of what each stage of a step took: of steps before the first cut, of those that cut, and of those after."""
    times = sorted(steps)
    cut_steps = [step for step in times
                 if any(abs(event.time_s - steps[step].time_s) < 0.5 * steps[step].time_step_s for event in cuts)]
    if not cut_steps:
        return {}
    groups = {"before": [step for step in times if step < cut_steps[0]][-AROUND:], "cutting": cut_steps,
              "after": [step for step in times if step > cut_steps[-1]][:AROUND]}
    return {name: {stage: 1e3 * quantile([getattr(steps[step], stage + "_s") for step in group], 0.5)
                   for stage in (*STAGES, "total")} | {"steps": len(group)}
            for name, group in groups.items() if group}


def summarise(path):
    """A dict of plain numbers. Times are the node's own wall times of each step, volumes those of the rest shape."""
    statuses, cuts, forces = read(path)
    first, last = statuses[0][1], statuses[-1][1]
    failed = [status.step for _, status in statuses if not status.converged]
    if failed:
        raise SummaryError(f"the solver failed in step {failed[0]} (and {len(failed) - 1} more)")
    # A status is also sent between steps, by services and at the start: each step counts once.
    steps = {status.step: status for _, status in statuses if status.step > 0}
    if not steps:
        raise SummaryError(f"{path} holds no step")
    step_ms = [1e3 * status.total_s for status in steps.values()]
    wall_s = statuses[-1][0] - statuses[0][0]
    cutting_steps = [1e3 * (status.cutting_s + status.update_s) for status in steps.values()]
    return {
        "cells_before": first.cells,
        "cells_after": last.cells,
        "tets_before": first.tets,
        "tets_after": last.tets,
        "vertices_before": first.vertices,
        "vertices_after": last.vertices,
        "pieces": last.pieces,
        "cuts": last.cuts,
        "cut_events": len(cuts),
        "cells_split": sum(event.cells_split for event in cuts),
        "cells_left_whole": last.cells_left_whole,
        "cut_area_m2": sum(event.cut_area_m2 for event in cuts),
        "steps": last.step,
        "steps_recorded": len(steps),
        "simulated_s": last.time_s,
        "wall_s": wall_s,
        "steps_per_second": 1e3 * len(step_ms) / sum(step_ms),
        "step_ms_median": quantile(step_ms, 0.5),
        "step_ms_p99": quantile(step_ms, 0.99),
        "step_ms_max": max(step_ms),
        "cut_ms_max": max(cutting_steps),
        "stages_ms": stages_ms(steps, cuts),
        "peak_force_n": max(forces),
        "volume_m3": last.volume_m3,
        "volume_relative_error": max(status.volume_relative_error for _, status in statuses),
        "bag": os.path.abspath(path),
    }


ROWS = [
    ("cells", lambda s: f"{s['cells_before']} -> {s['cells_after']} ({s['tets_after']} tets)"),
    ("vertices", lambda s: f"{s['vertices_before']} -> {s['vertices_after']}"),
    ("pieces", lambda s: f"{s['pieces']}"),
    ("cuts", lambda s: f"{s['cuts']} ({s['cells_split']} cells split, {s['cells_left_whole']} left whole)"),
    ("cut area", lambda s: f"{1e4 * s['cut_area_m2']:.2f} cm^2"),
    ("simulated", lambda s: f"{s['simulated_s']:.2f} s in {s['steps']} steps"),
    ("a step", lambda s: f"median {s['step_ms_median']:.2f} ms, 99 % {s['step_ms_p99']:.2f} ms, "
                         f"most {s['step_ms_max']:.2f} ms"),
    ("steps a second", lambda s: f"{s['steps_per_second']:.1f} by the time spent in steps"),
    ("cutting, at most", lambda s: f"{s['cut_ms_max']:.2f} ms in one step"),
    ("peak force", lambda s: f"{s['peak_force_n']:.3f} N on the tool"),
    ("volume error", lambda s: f"{s['volume_relative_error']:.2e} relative"),
]


def table(summary):
    lines = [f"  {name:<18}{text(summary)}" for name, text in ROWS]
    if summary["stages_ms"]:
        lines.append("  medians [ms]      " + "".join(f"{stage:>11}" for stage in (*STAGES, "step")))
        for name, stages in summary["stages_ms"].items():
            lines.append(f"    {name + ', ' + str(stages['steps']):<16}"
                         + "".join(f"{stages[stage]:11.2f}" for stage in (*STAGES, "total")))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bag")
    parser.add_argument("--output", help="write the numbers as JSON to this file")
    arguments = parser.parse_args()
    try:
        summary = summarise(arguments.bag)
    except (SummaryError, OSError, rosbag.ROSBagException) as error:
        print(f"bag_summary: {error}", file=sys.stderr)
        return 1
    print(table(summary))
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            json.dump(summary, file, indent=2)
            file.write("\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
