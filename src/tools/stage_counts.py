# SPDX-License-Identifier: BSD-3-Clause
"""Instructions and memory traffic of the stages of a step, as callgrind counts them on a processor that it simulates."""

import glob
import os
import shutil
import subprocess

LINE_BYTES = 64
# Those of a usual core alone, so that every machine counts the same; what misses the last one is fetched from caches that
# cores share, or from memory.
CACHES = [f"--I1=32768,8,{LINE_BYTES}", f"--D1=32768,8,{LINE_BYTES}", f"--LL=524288,8,{LINE_BYTES}"]
TIMEOUT_S = 600

# Every stage goes through more than twice what these caches hold, so what it has to move is fetched. Less would mean that the
# least was counted too high.
LEAST_PART = 0.8


class CountError(Exception):
    """The stages could not be counted."""


def _finish(process, what):
    try:
        output, errors = process.communicate(timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise CountError(f"{what} took more than {TIMEOUT_S} s") from None
    if process.returncode != 0:
        raise CountError(f"{what}: {errors.strip() or output.strip()}")
    return output


def _start(command):
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _read_dump(path):
    """Stage and counts by event of one dump; the stage is None in the dump of what came after the last one."""
    trigger, values = "desc: Trigger: Client Request: ", {}
    stage = None
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith(trigger):
                stage = line[len(trigger):].strip()
            key, _, rest = line.partition(": ")
            if key in ("events", "summary"):
                values[key] = rest.split()
    if set(values) != {"events", "summary"}:
        raise CountError(f"{path} is no dump of callgrind")
    return stage, dict(zip(values["events"], map(int, values["summary"])))


def _add(row, counts, registers):
    row["instructions_each"] = counts["Ir"] / row["items"]
    row["instructions_per_ns"] = counts["Ir"] / (1e6 * row["time_ms"])
    row["fetched_mb"] = 1e-6 * LINE_BYTES * (counts["ILmr"] + counts["DLmr"] + counts["DLmw"])
    row["registers"] = registers
    row["fetched_part"] = row["fetched_mb"] / row["least_mb"]
    row["held"] += f"; fetched_part >= {LEAST_PART}"
    row["holds"] = row["holds"] and row["fetched_part"] >= LEAST_PART


def count(program, folder, rows):
    """Adds to each row of a subject that the program knows what its stage came to; raises CountError with the reason."""
    valgrind = shutil.which("valgrind")
    if not valgrind:
        raise CountError("valgrind is not installed")
    subjects = _finish(_start([program]), "the list of subjects").split()
    processes = {}
    try:
        for subject in subjects:
            out = os.path.join(folder, f"callgrind.{subject}")
            for old in glob.glob(glob.escape(out) + "*"):
                os.remove(old)
            processes[subject] = _start([valgrind, "-q", "--tool=callgrind", "--instr-atstart=no", "--cache-sim=yes", *CACHES,
                                         f"--callgrind-out-file={out}", program, subject])
        for subject, process in processes.items():
            registers = _finish(process, f"callgrind of {subject}").strip()
            dumps = sorted(glob.glob(glob.escape(os.path.join(folder, f"callgrind.{subject}.")) + "*"))
            counts = dict(_read_dump(path) for path in dumps)
            for row in rows:
                if row.get("subject") != subject or "time_ms" not in row:
                    continue
                if row["stage"] not in counts:
                    raise CountError(f"callgrind of {subject} did not count {row['stage']}")
                _add(row, counts[row["stage"]], registers)
    finally:
        for process in processes.values():
            if process.poll() is None:
                process.kill()
                process.wait()
