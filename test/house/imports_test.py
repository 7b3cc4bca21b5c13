#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the tree against the directions of DESIGN: which module may include which, where each foreign library may be
seen, and what may lie at the top. Debian keeps the ROS headers in /usr/include, so the compiler cannot do this."""

import os
import re
import shutil
import subprocess
import sys
import tempfile

# Module -> modules whose headers it may include besides its own.
BELOW = {
    "core": set(),
    "geometry": {"core"},
    "mesh": {"core", "geometry"},
    "cutting": {"core", "geometry", "mesh"},
    "materials": {"core"},
    "elements": {"core", "geometry", "mesh", "materials"},
    "solver": {"core"},
    "collision": {"core", "geometry", "mesh"},
    "simulation": {"core", "geometry", "mesh", "cutting", "materials", "elements", "solver", "collision"},
    "ros_bridge": {"core", "geometry", "mesh", "cutting", "materials", "elements", "solver", "collision", "simulation"},
}

# Foreign header -> files that may include it.
FOREIGN = [
    (r"(suitesparse/)?cholmod|cblas", r"src/solver/[^/]+\.[ch]pp"),
    (r"fcl/", r"src/collision/[^/]+\.cpp"),
    (r"gmsh\.h", r"src/mesh/[^/]+\.cpp"),
    (r"CGAL/(Exact_|MP_Float|Lazy)", r"src/geometry/predicates\.cpp"),
    (r"CGAL/", r"src/(geometry/predicates|mesh/[^/]+|collision/tool_mesh)\.cpp"),
    (r"(ros|tf2[a-z_]*|[a-z_]+_msgs|std_srvs|diagnostic_updater|rosbag|XmlRpc[A-Za-z]*|yaml-cpp|polyscalpel)/"
     r"(?!(core|geometry|mesh|cutting|materials|elements|solver|collision|simulation)/)",
     r"(src|include/polyscalpel)/ros_bridge/[^/]+"),
]
ONE_FILE_ONLY = [r"gmsh\.h"]

TOP = {
    "CMakeLists.txt", "package.xml", "src", "include", "msg", "srv", "launch", "config", "test", "README.md", "LICENSE",
    "CHANGELOG.rst", "CMakePresets.json", ".clang-format", ".clang-tidy", ".gitignore", "run", ".ci",
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
MODULE_FILE = re.compile(r"^(?:src|include/polyscalpel)/([a-z_]+)/[^/]+\.(?:cpp|hpp)$")
OUR_HEADER = re.compile(r"^polyscalpel/([a-z_]+)/")


def sources(root):
    for folder in ("src", "include"):
        for path, _, names in sorted(os.walk(os.path.join(root, folder))):
            for name in sorted(names):
                if name.endswith((".cpp", ".hpp", ".h")):
                    yield os.path.relpath(os.path.join(path, name), root)


def include_faults(root):
    faults = []
    users = {pattern: [] for pattern in ONE_FILE_ONLY}
    for name in sources(root):
        match = MODULE_FILE.match(name)
        if not match or match.group(1) not in BELOW:
            faults.append(f"{name}: belongs to no module")
            continue
        module = match.group(1)
        with open(os.path.join(root, name), encoding="utf-8") as file:
            text = file.read()
        if module != "ros_bridge" and re.search(r"\b(ros|tf2|tf)::[A-Za-z]", re.sub(r"//.*", "", text)):
            faults.append(f"{name}: names a ROS type")
        for header in INCLUDE.findall(text):
            if re.search(r"(^|/)\.\.?/|^src/", header) or re.match(r"(%s)/" % "|".join(BELOW), header):
                faults.append(f"{name}: {header} is private to its own folder")
            ours = OUR_HEADER.match(header)
            if ours and ours.group(1) in BELOW and ours.group(1) != module and ours.group(1) not in BELOW[module]:
                faults.append(f"{name}: {module} may not include {header}")
            for pattern, allowed in FOREIGN:
                if re.match(pattern, header) and not re.fullmatch(allowed, name):
                    faults.append(f"{name}: may not include {header}")
                    break
            for pattern in ONE_FILE_ONLY:
                if re.match(pattern, header):
                    users[pattern].append(name)
    for pattern, names in users.items():
        if len(names) > 1:
            faults.append(f"{pattern} is included by more than one file: {', '.join(names)}")
    return faults


def top_faults(root):
    listing = ""
    if shutil.which("git"):
        listing = subprocess.run(["git", "-c", "safe.directory=*", "-C", root, "ls-files"], capture_output=True,
                                 text=True, check=False).stdout
    if listing:
        entries = {line.split("/")[0] for line in listing.splitlines()}
    else:  # an unpacked archive, or a machine without git
        entries = {entry for entry in os.listdir(root) if entry not in (".git", "devel") and not entry.startswith("build")}
    faults = [f"{entry}: does not belong at the top" for entry in sorted(entries - TOP)]
    return faults + [f"{entry}: is missing at the top" for entry in sorted(TOP - entries)]


def write(root, name, text):
    os.makedirs(os.path.dirname(os.path.join(root, name)), exist_ok=True)
    with open(os.path.join(root, name), "w", encoding="utf-8") as file:
        file.write(text)


def own_faults():
    """Whether this test still sees what it is there to see: file, include, and whether it is a fault."""
    samples = [
        ("src/mesh/a.cpp", "ros/ros.h", True),
        ("src/mesh/a.cpp", "geometry_msgs/Point.h", True),
        ("src/simulation/a.cpp", "tf2/utils.h", True),
        ("src/simulation/a.cpp", "polyscalpel/CutEvent.h", True),
        ("src/simulation/a.cpp", "yaml-cpp/yaml.h", True),
        ("src/ros_bridge/a.cpp", "ros/ros.h", False),
        ("src/ros_bridge/a.cpp", "polyscalpel/CutEvent.h", False),
        ("src/solver/a.cpp", "cholmod.h", False),
        ("src/solver/a.hpp", "cholmod.h", False),
        ("src/solver/a.cpp", "cholmod_handles.hpp", False),
        ("src/simulation/a.cpp", "../solver/cholmod_handles.hpp", True),
        ("src/simulation/a.cpp", "solver/cholmod_handles.hpp", True),
        ("src/simulation/a.cpp", "cholmod.h", True),
        ("src/simulation/a.hpp", "cblas.h", True),
        ("src/collision/a.cpp", "suitesparse/cholmod.h", True),
        ("include/polyscalpel/solver/a.hpp", "cholmod.h", True),
        ("src/collision/a.cpp", "fcl/fcl.h", False),
        ("include/polyscalpel/collision/a.hpp", "fcl/fcl.h", True),
        ("src/geometry/predicates.cpp", "CGAL/Exact_predicates_inexact_constructions_kernel.h", False),
        ("src/geometry/polygon.cpp", "CGAL/Exact_predicates_inexact_constructions_kernel.h", True),
        ("src/mesh/a.cpp", "CGAL/Exact_predicates_inexact_constructions_kernel.h", True),
        ("src/mesh/a.cpp", "CGAL/IO/polygon_soup_io.h", False),
        ("src/cutting/a.cpp", "CGAL/Surface_mesh.h", True),
        ("src/mesh/mesh_io.cpp", "gmsh.h", False),
        ("src/cutting/a.cpp", "gmsh.h", True),
        ("src/mesh/a.cpp", "polyscalpel/cutting/cut_mesh.hpp", True),
        ("src/cutting/a.cpp", "polyscalpel/mesh/surface.hpp", False),
        ("src/solver/a.cpp", "polyscalpel/mesh/surface.hpp", True),
        ("src/collision/a.cpp", "polyscalpel/elements/assembly.hpp", True),
        ("src/simulation/a.cpp", "polyscalpel/ros_bridge/conversions.hpp", True),
        ("src/other/a.cpp", "vector", True),
    ]
    faults = []
    for name, header, is_fault in samples:
        with tempfile.TemporaryDirectory() as root:
            write(root, name, f"#include <{header}>\n")
            if bool(include_faults(root)) != is_fault:
                faults.append(f"this test misjudges {name} with {header}")
    with tempfile.TemporaryDirectory() as root:
        write(root, "src/mesh/a.cpp", "#include <gmsh.h>\n")
        write(root, "src/mesh/b.cpp", "#include <gmsh.h>\n")
        if not include_faults(root):
            faults.append("this test misses gmsh.h in two files")
    with tempfile.TemporaryDirectory() as root:
        for entry in TOP | {"stray.txt"}:
            write(root, entry, "")
        if top_faults(root) != ["stray.txt: does not belong at the top"]:
            faults.append("this test misses a stray file at the top")
    return faults


def main():
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    faults = own_faults() + include_faults(root) + top_faults(root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
