# SPDX-License-Identifier: MIT
"""Runs processes with limits of processor time and memory."""

import dataclasses
import os
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import time

LAST_OUTPUT = 200000  # so much of the output is kept [bytes]


@dataclasses.dataclass
class Ran:
    status: str  # passed, failed or stopped: for want of time
    seconds: float  # of the processor
    output: str = ""
    code: int = 0


class Stopped(Exception):
    """The campaign was interrupted."""


class Runner:
    """Runs processes with a limit of processor time. stop() ends those that are running."""

    def __init__(self):
        self._running = set()
        self._is_stopped = False

    def stop(self):
        self._is_stopped = True
        for process in list(self._running):
            _end(process)

    def run(self, command, seconds, folder, memory=None, environment=None, idle=None):
        """Runs a command in a folder; ends it if it does nothing for `idle` seconds. With a limit
        of memory [bytes], no file becomes larger than an eighth of it."""
        limit = max(1, int(seconds))

        def limits():
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if memory:
                resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
                resource.setrlimit(resource.RLIMIT_FSIZE, (memory // 8, memory // 8))

        with tempfile.TemporaryFile(dir=folder) as output:
            if self._is_stopped:
                raise Stopped
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT,
                                       stdin=subprocess.DEVNULL, cwd=folder, preexec_fn=limits,
                                       start_new_session=True, env=environment)
            self._running.add(process)
            if self._is_stopped:  # meanwhile
                _end(process)
            try:
                used, hangs = _wait(process, idle)
            finally:
                self._running.discard(process)
            if self._is_stopped:
                raise Stopped
            output.seek(max(0, output.seek(0, os.SEEK_END) - LAST_OUTPUT))
            text = output.read().decode(errors="replace")
        code = process.returncode
        too_long = (hangs or used >= limit or code in (-signal.SIGXCPU, 128 + signal.SIGXCPU)
                    or "CPU time limit exceeded" in text)  # g++ says it of a part of itself
        status = "passed" if code == 0 else "stopped" if too_long else "failed"
        return Ran(status, used, text, code)


def _end(process):
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def _wait(process, idle):
    """Waits for a process; returns its processor time, and whether it was ended because it hung.
    Elapsed time would depend on what else the machine does."""
    last_active, next_look, hangs = time.monotonic(), 0, False
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            _end(process)  # children that it left
            return usage.ru_utime + usage.ru_stime, hangs
        now = time.monotonic()
        if now > next_look:
            next_look = now + 1
            if _is_active(process):
                last_active = now
            if idle and now - last_active > idle:
                hangs = True
                _end(process)
        time.sleep(0.05)


def _is_active(process):
    """Whether one of its threads runs or would run; true where the system does not say."""
    threads = pathlib.Path(f"/proc/{process.pid}/task")
    if not threads.is_dir():
        return True
    for path in threads.glob("*/stat"):
        try:
            state = path.read_text(encoding="utf-8").rsplit(")", 1)[1].split()[0]
        except OSError:
            continue  # the thread has ended
        if state in ("R", "D"):
            return True
    return False


def cause_of(ran):
    """The first test that failed, or how the program ended."""
    if failed := re.search(r"^\[  FAILED  \] ([^\s,]+)", ran.output, re.MULTILINE):
        return failed.group(1)
    if ran.status == "stopped":
        return "too slow"
    if ran.code < 0:
        running = re.findall(r"^\[ RUN      \] (\S+)", ran.output, re.MULTILINE)
        return f"{running[-1] + ' ' if running else ''}signal {-ran.code}"
    return ran.output if ran.output == "other hashes" else f"exit {ran.code}"
