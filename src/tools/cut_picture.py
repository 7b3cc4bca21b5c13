# SPDX-License-Identifier: BSD-3-Clause
"""The report's picture of a cut body in rviz."""

import os

import pictures
from child_processes import ChildProcesses
from ros_master import use_own_folders

BACKGROUND = "rgb(33,38,46)"  # of config/polyscalpel.rviz

# From in front, a little above.
VIEW = {"Distance": 0.29, "Pitch": 0.25, "Yaw": 4.9, "Focal Point": {"X": 0, "Y": 0, "Z": 0}}


def make(program, bunny_mesh, folder, picture):
    """What the picture shows, once it is made; raises PictureError with the reason. bunny_mesh: empty where there is none."""
    bag = os.path.join(folder, "cut_body.bag")
    shown = pictures.run([program, bag] + ([bunny_mesh] if bunny_mesh else []), "the cut body", 300).strip()
    logs = os.path.join(folder, "log")
    use_own_folders(logs)
    children = ChildProcesses(logs)
    try:
        pictures.make_pictures(children, os.path.abspath(bag), [(None, picture)], VIEW, has_table=False)
    finally:
        children.stop_all()
    pictures.run(["convert", picture, "-trim", "+repage", "-bordercolor", BACKGROUND, "-border", "10", picture], "convert", 60)
    return shown
