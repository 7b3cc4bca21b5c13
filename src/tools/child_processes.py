# SPDX-License-Identifier: BSD-3-Clause
"""Processes that are ended, with all they have started, when the program that owns them ends."""

import os
import signal
import subprocess
import time


def _children():
    """Process id -> ids of its children, for all that run now."""
    children = {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as file:
                    parent = int(file.read().rpartition(")")[2].split()[1])
            except (OSError, IndexError, ValueError):  # it has just ended
                continue
            children.setdefault(parent, []).append(int(entry))
    return children


def _start_time(pid):
    """Clock ticks since boot at which a process started, or None: a process id may be given to another one later."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
            return int(file.read().rpartition(")")[2].split()[19])
    except (OSError, IndexError, ValueError):
        return None


def _descendants(pid):
    children = _children()
    found, queue = [], [pid]
    while queue:
        for child in children.get(queue.pop(), []):
            found.append(child)
            queue.append(child)
    return found


def _signal(pid, number):
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        pass


class ChildProcesses:
    """Starts processes, each with its output in a log file, and stops them in reverse order."""

    def __init__(self, log_folder):
        self._log_folder = log_folder
        self._running = []  # (name, process), in the order in which they were started
        os.makedirs(log_folder, exist_ok=True)

    def log_path(self, name):
        return os.path.join(self._log_folder, name + ".log")

    def start(self, name, command, **options):
        """Starts a process in a session of its own, so that Ctrl-C reaches this program only."""
        with open(self.log_path(name), "wb") as log:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                       start_new_session=True, **options)
        self._running.append((name, process))
        return process

    def ended(self):
        """Name and exit status of a process that has ended by itself, or None."""
        for name, process in self._running:
            if process.poll() is not None:
                return name, process.returncode
        return None

    def stop(self, process, patience_s=25):
        """Asks a process to end as Ctrl-C does; ends it and all it has started by force when it does not."""
        self._running = [(name, other) for name, other in self._running if other is not process]
        family = {pid: _start_time(pid) for pid in [process.pid] + _descendants(process.pid)}
        if process.poll() is None:
            _signal(process.pid, signal.SIGINT)
            try:
                process.wait(patience_s)
            except subprocess.TimeoutExpired:
                pass
        for number in (signal.SIGTERM, signal.SIGKILL):
            left = [pid for pid, start in family.items() if start is not None and _start_time(pid) == start]
            if process.poll() is not None:
                left = [pid for pid in left if pid != process.pid]
            for pid in left:
                _signal(pid, number)
            deadline = time.monotonic() + 3
            while left and time.monotonic() < deadline:
                process.poll()
                left = [pid for pid in left if _start_time(pid) == family[pid]]
                time.sleep(0.05)
        process.wait()

    def stop_all(self):
        while self._running:
            self.stop(self._running[-1][1])
