#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures speed against error and writes the report; see `./run help`.

Runs the program polyscalpel_report, which measures and writes report.json, has callgrind count instructions, takes a picture of a cut
body in rviz, then draws the plots and writes REPORT.md from that file. Ends with 1 where a value that the report holds is broken: the
report is written all the same and names it.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time

import bunny
import cut_picture
import pictures
import report_plots
import report_text
import stage_counts

# Packages whose versions bear on the figures.
PACKAGES = {"CHOLMOD": "libcholmod3", "OpenBLAS": "libopenblas0-pthread", "Eigen": "libeigen3-dev", "FCL": "libfcl-dev",
            "CGAL": "libcgal-dev", "Gmsh": "libgmsh-dev", "Bullet": "libbullet-dev", "TetGen": "tetgen",
            "Valgrind": "valgrind", "matplotlib": "python3-matplotlib"}

PICTURE = "cut_body.png"


def package_versions():
    versions = {}
    for name, package in PACKAGES.items():
        found = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True,
                               check=False)
        versions[name] = found.stdout.strip() if found.returncode == 0 and found.stdout.strip() else "not installed"
    return versions


def commit(root):
    if not shutil.which("git"):
        return "unknown: there is no git here"

    def git(*arguments):
        return subprocess.run(["git", "-c", "safe.directory=*", "-C", root, *arguments], capture_output=True, text=True,
                              check=False).stdout.strip()

    # What the report itself writes does not make the sources others.
    changed = git("status", "--porcelain", "--", ".", ":!test/benchmark/REPORT.md", ":!test/benchmark/*.png")
    return (git("rev-parse", "HEAD") or "unknown") + (" with local changes" if changed else "")


def find_bunny(arguments):
    """Path of the bunny's mesh, empty where it could not be had, and how it was made, or why it is not there."""
    try:
        return (bunny.make_bunny(os.path.join(arguments.folder, "bunny")),
                f"npm package {bunny.PACKAGE}, filled by TetGen {bunny.TETGEN_OPTIONS}, {bunny.SIZE_M} m long")
    except (bunny.BunnyError, OSError, KeyError) as error:
        return "", f"the bunny could not be had: {error}"


def read_figures(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write_figures(report, path):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(report, file, indent=1)
        file.write("\n")


def count_stages(arguments, path):
    """Adds to the figures of the limits what callgrind counts, or a row that says why it does not. Whether they all hold."""
    report = read_figures(path)
    rows = report["limits"] = [row for row in report["limits"] if "note" not in row]
    try:
        if arguments.mode == "quick":
            raise stage_counts.CountError("a quick run leaves it out")
        print("report: counting instructions", file=sys.stderr)
        stage_counts.count(arguments.count_program, arguments.folder, rows)
    except (stage_counts.CountError, OSError) as error:
        print(f"report: no instructions are counted: {error}", file=sys.stderr)
        rows.append({"body": "callgrind", "stage": "not counted", "note": str(error)})
    write_figures(report, path)
    broken = [row for row in rows if row.get("fetched_part", 1) < stage_counts.LEAST_PART]
    for row in broken:
        print(f"limits: {row['held']} does not hold in {json.dumps(row)}", file=sys.stderr)
    return not broken


def take_picture(arguments, path, bunny_mesh, note):
    """Adds to the figures what the picture shows, or why there is none."""
    report = read_figures(path)
    try:
        shown = cut_picture.make(arguments.picture_program, bunny_mesh, arguments.folder,
                                 os.path.join(arguments.target, PICTURE))
        report["picture"] = {"file": PICTURE, "shows": shown if bunny_mesh else f"{shown}; {note}"}
    except (pictures.PictureError, OSError) as error:
        print(f"report: no picture: {error}", file=sys.stderr)
        report["picture"] = {"missing": f"no picture in rviz: {error}"}
    write_figures(report, path)


def measure(arguments, root, path, bunny_mesh, note):
    command = [arguments.program, "--output", path, "--mode", arguments.mode, "--commit", commit(root), "--bunny-note", note]
    if bunny_mesh:
        command += ["--bunny", bunny_mesh]
    for name, version in package_versions().items():
        command += ["--version", f"{name}={version}"]
    return subprocess.run(command, check=False).returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="the program that measures; without it the figures of the last run are drawn anew")
    parser.add_argument("--count-program", help="the program whose stages callgrind counts; without it none are counted")
    parser.add_argument("--picture-program", help="the program that makes the markers of the picture; without it none is taken")
    parser.add_argument("--folder", required=True, help="where report.json and what is made on the spot go")
    parser.add_argument("--target", required=True, help="where REPORT.md and its plots go")
    parser.add_argument("--mode", choices=["quick", "default", "full"], default="default")
    arguments = parser.parse_args()
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    path = os.path.join(arguments.folder, "report.json")
    os.makedirs(arguments.folder, exist_ok=True)
    status = 0
    bunny_mesh, note = find_bunny(arguments)
    if arguments.program:
        if os.path.exists(path):
            os.remove(path)
        status = measure(arguments, root, path, bunny_mesh, note)
        if not os.path.exists(path):
            print("report: nothing was measured", file=sys.stderr)
            return status or 2
    if arguments.count_program and not count_stages(arguments, path):
        status = status or 1
    if arguments.picture_program:
        take_picture(arguments, path, bunny_mesh, note)
    report = read_figures(path)
    plots = {name for name, draw in report_plots.PLOTS.items()
             if draw(report[name], os.path.join(arguments.target, name + ".png"))}
    text = report_text.write(report, plots, time.strftime("%Y-%m-%d", time.gmtime(os.path.getmtime(path))))
    target = os.path.join(arguments.target, "REPORT.md")
    with open(target, "w", encoding="utf-8") as file:
        file.write(text)
    print(f"{os.path.relpath(target, root)} and its plots are written; the figures are in {os.path.relpath(path, root)}")
    return status


if __name__ == "__main__":
    sys.exit(main())
