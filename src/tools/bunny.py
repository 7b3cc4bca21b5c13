# SPDX-License-Identifier: BSD-3-Clause
"""The Stanford bunny as tetrahedra, made on the spot: its surface from the npm package `bunny` (public domain), filled by
TetGen. Nothing of it is kept in the repository."""

import glob
import json
import os
import re
import shutil
import subprocess
import tarfile

PACKAGE = "bunny@1.0.1"
SIZE_M = 0.1
# The surface's own triangles stay; radius over shortest edge at most 1.6.
TETGEN_OPTIONS = "-pYq1.6g"


class BunnyError(Exception):
    """The bunny could not be had."""


def _run(command, folder):
    if shutil.which(command[0]) is None:
        raise BunnyError(f"{command[0]} is not installed")
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False,
                              stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        raise BunnyError(f"{command[0]} took more than 120 s") from None
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()
        raise BunnyError(f"{' '.join(command)} failed: {lines[-1]}")


def _write_surface(script, path):
    """The package is a script that exports two lists, of points and of triangles. Its y points up: here z does."""
    with open(script, encoding="utf-8") as file:
        text = file.read()
    lists = [re.search(name + r"\s*=\s*(\[\[.*?\]\])", text, re.DOTALL) for name in ("positions", "cells")]
    if None in lists:
        raise BunnyError("the package does not hold what it held")
    points, triangles = (json.loads(found.group(1)) for found in lists)
    points = [(x, -z, y) for x, y, z in points]
    lowest = [min(axis) for axis in zip(*points)]
    scale = SIZE_M / max(max(axis) - low for axis, low in zip(zip(*points), lowest))
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        for point in points:
            file.write(" ".join(f"{scale * (x - low):.9g}" for x, low in zip(point, lowest)) + "\n")
        for triangle in triangles:
            file.write("3 " + " ".join(str(corner) for corner in triangle) + "\n")


def make_bunny(folder):
    """Path of the volume mesh in the folder, made unless it is there; raises BunnyError with the reason."""
    mesh = os.path.join(folder, "bunny.1.mesh")
    if os.path.exists(mesh):
        return mesh
    os.makedirs(folder, exist_ok=True)
    archives = os.path.join(folder, "bunny-*.tgz")
    if not glob.glob(archives):
        _run(["npm", "pack", "--silent", PACKAGE], folder)
    with tarfile.open(glob.glob(archives)[0]) as archive:
        script = archive.extractfile("package/index.js")
        with open(os.path.join(folder, "bunny.js"), "wb") as file:
            shutil.copyfileobj(script, file)
    _write_surface(os.path.join(folder, "bunny.js"), os.path.join(folder, "bunny.off"))
    _run(["tetgen", TETGEN_OPTIONS, "bunny.off"], folder)
    if not os.path.exists(mesh):
        raise BunnyError("tetgen wrote no mesh")
    return mesh
