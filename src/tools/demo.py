#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The demonstration: a scalpel presses and slices an organ, or draws a spiral through it; see `./run help`.

Runs demo.launch on a port of its own, shows how it goes, then plays the bag that it recorded into rviz for two pictures.
Everything it writes lies in one folder, and every process it starts ends with it.
"""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import time

import genpy
import rosbag
import rosgraph
import rospy
import yaml

import bag_summary
import pictures
from child_processes import ChildProcesses
from polyscalpel.msg import StepStatus
from ros_master import master_port, use_new_master, use_own_folders

STALL_S = 120  # without any step for so long the demonstration has failed

# Name -> scene, and what is otherwise in rviz's view of its pictures.
SHOWS = {"demo": ("organ", {}), "spiral": ("spiral", {"Pitch": 1.15, "Distance": 0.2})}

DRAINED_S = 3  # without any step for so long after the end of the path all poses are used up


class DemoError(Exception):
    """The demonstration has failed; the text says why."""


def has_screen():
    if not os.environ.get("DISPLAY"):
        return False
    try:
        return subprocess.run(["xdpyinfo"], capture_output=True, timeout=10, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


class Progress:
    """Listens to status and shows one line."""

    def __init__(self, end_s):
        self._end_s = end_s
        self._is_terminal = sys.stdout.isatty()
        self._shown_at = 0.0
        self._shown_step = -1
        self.last = None
        self.last_step_at = time.monotonic()
        self._subscriber = rospy.Subscriber("status", StepStatus, self._on_status, queue_size=1000)

    def _on_status(self, status):
        if self.last is None or status.step > self.last.step:
            self.last_step_at = time.monotonic()
        self.last = status

    def show(self, is_last=False):
        now = time.monotonic()
        status = self.last
        if status is None or (not is_last and (status.step == self._shown_step or
                                               now - self._shown_at < (0.2 if self._is_terminal else 2.0))):
            return
        self._shown_at, self._shown_step = now, status.step
        line = (f"  {status.time_s:6.2f} of {self._end_s:.2f} s   {status.steps_per_second:6.1f} steps/s   "
                f"{status.cells} cells   {status.pieces} piece{'s' if status.pieces != 1 else ''}   "
                f"{status.contacts} contacts")
        if self._is_terminal:
            print("\r\033[K" + line, end="\n" if is_last else "", flush=True)
        else:
            print(line, flush=True)


def log_tail(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return "".join(file.readlines()[-15:])
    except OSError:
        return ""


def simulate(children, arguments, bag, end_s):
    """Runs demo.launch until the tool has come to the end of its path."""
    screen = has_screen() and not arguments.no_rviz
    launch = children.start("simulation", [
        "roslaunch", "-p", master_port(), "polyscalpel", "demo.launch", f"bag:={bag}", f"scene:={arguments.scene}",
        f"path:={arguments.path}", f"rviz:={'true' if screen else 'false'}"])
    log = children.log_path("simulation")
    print("Simulating" + (", shown in rviz" if screen else ""), flush=True)
    progress = None
    started = time.monotonic()
    while True:
        ended = children.ended()
        if ended:
            raise DemoError(f"{ended[0]} ended early, see {children.log_path(ended[0])}:\n"
                            + log_tail(children.log_path(ended[0])))
        if progress is None and rosgraph.is_master_online():
            rospy.init_node("demo_progress", anonymous=True, disable_signals=True, log_level=rospy.WARN)
            progress = Progress(end_s)
        if progress is not None:
            progress.show()
            last = progress.last
            if last is not None and not last.converged:
                raise DemoError(f"step {last.step} failed: {last.message}")
            if last is not None and last.time_s > end_s - 1.5 * last.time_step_s:
                break
        if time.monotonic() - (progress.last_step_at if progress else started) > STALL_S:
            raise DemoError(f"no step for {STALL_S} s, see {log}:\n{log_tail(log)}")
        time.sleep(0.05)
    # The last steps, and their way to the bag: all that the poses allow, so that every run ends with the same step.
    while time.monotonic() - progress.last_step_at < DRAINED_S:
        time.sleep(0.05)
    progress.show(is_last=True)
    return launch


def picture_time(bag):
    """Seconds after the bag's start of the last moment before the first cut."""
    with rosbag.Bag(bag) as recorded:
        for _, _, stamp in recorded.read_messages(topics=["/cut_events"]):
            return max(0.5, stamp.to_sec() - recorded.get_start_time() - 0.5)
    raise DemoError("the blade has cut nothing")


def demonstrate(children, arguments):
    bag = os.path.join(arguments.output, arguments.name + ".bag")
    with open(arguments.path, encoding="utf-8") as file:
        end_s = yaml.safe_load(file)["key_frames"][-1]["time_s"]

    launch = simulate(children, arguments, bag, end_s)
    rospy.signal_shutdown("the simulation is over")
    children.stop(launch)
    summary = bag_summary.summarise(bag)
    if summary["cuts"] == 0:
        raise DemoError("the blade has cut nothing")

    print("Taking pictures in rviz", flush=True)
    before, after = (os.path.join(arguments.output, name) for name in ("before.png", "after.png"))
    pictures.make_pictures(children, bag, [(picture_time(bag), before), (None, after)], arguments.view)
    summary["pictures"] = [before, after]

    path = os.path.join(arguments.output, "summary.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(summary, file, indent=2)
        file.write("\n")
    print(bag_summary.table(summary))
    for name in (os.path.basename(bag), "before.png", "after.png", "summary.json"):
        print(f"  {os.path.relpath(os.path.join(arguments.output, name))}")


def parse():
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--name", choices=sorted(SHOWS), default="demo", help="what is shown; its defaults for the rest")
    parser.add_argument("--output", help="folder, emptied first; by default build/<name>")
    parser.add_argument("--scene", help="by default that of the name")
    parser.add_argument("--path", help="key frames of the scalpel")
    parser.add_argument("--no-rviz", action="store_true", help="do not open rviz where there is a screen")
    arguments = parser.parse_args()
    scene, arguments.view = SHOWS[arguments.name]
    defaults = {"output": os.path.join("build", arguments.name),
                "scene": os.path.join("config", "scenes", scene + ".yaml"),
                "path": os.path.join("config", "tools", arguments.name + "_scalpel.yaml")}
    for name, default in defaults.items():
        setattr(arguments, name, os.path.abspath(getattr(arguments, name) or os.path.join(root, default)))
    return arguments


def on_terminate(number, _):
    raise KeyboardInterrupt(number)


def main():
    arguments = parse()
    signal.signal(signal.SIGTERM, on_terminate)
    signal.signal(signal.SIGHUP, on_terminate)
    shutil.rmtree(arguments.output, ignore_errors=True)
    logs = os.path.join(arguments.output, "log")
    use_own_folders(logs)
    use_new_master()
    children = ChildProcesses(logs)
    try:
        demonstrate(children, arguments)
        return 0
    except (DemoError, bag_summary.SummaryError, pictures.PictureError, rosbag.ROSBagException, genpy.MessageException,
            OSError) as error:
        print(f"\ndemo: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ndemo: interrupted", file=sys.stderr)
        return 130
    finally:
        # A second Ctrl-C must not leave processes behind.
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        children.stop_all()


if __name__ == "__main__":
    sys.exit(main())
