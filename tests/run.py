#!/usr/bin/env python3
"""Run cmocka test binaries, each in its own network namespace and with a time limit.

Prints one line per binary, and the whole output of a binary that fails. A binary fails if it crashes, exceeds the time
limit, runs no test or leaves a process running. The last line is `N passed, N failed`; the exit code is 1 if any
failed.
"""
import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

MARK = "SIDESTEP_TEST"  # in the environment of every process that a test starts
MULTICAST = 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"'
LEAVE_S = 1.0  # time for the processes of a finished test to end


class Outcome(NamedTuple):
    binary: Path
    passed: int
    failed: int
    skipped: int
    seconds: float
    reason: str  # of a failure other than failed tests
    output: str


def isolation():
    """The command prefix that runs a test in its own network namespace; empty if not permitted."""
    for unshare in (["unshare", "-n"], ["unshare", "-rn"]):
        command = [*unshare, "sh", "-c", MULTICAST, "sh"]
        try:
            if subprocess.run([*command, "true"], capture_output=True, timeout=10).returncode == 0:
                return command
        except (OSError, subprocess.TimeoutExpired):
            pass
    print("network namespaces are not permitted: the tests share the network of this machine")
    return []


def count(output):
    """(passed, failed, skipped) from cmocka's messages; announced tests without a result have failed."""
    announced = sum(map(int, re.findall(r"\[==========\] Running (\d+) test\(s\)", output)))
    passed = len(re.findall(r"\[       OK \] ", output))
    skipped = sum(map(int, re.findall(r"\[  SKIPPED \] (\d+) test\(s\)", output)))
    return passed, max(announced - passed - skipped, 0), skipped


def marked(mark):
    """Ids of the running processes with this mark in their environment."""
    wanted, found = f"{MARK}={mark}".encode(), []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (entry / "environ").read_bytes().split(b"\0"):
                found.append(int(entry.name))
        except OSError:  # ended, or owned by another user
            pass
    return found


def name_of(process):
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    except OSError:
        return "ended"


def kill(processes):
    for process in processes:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


def left_behind(mark):
    """Kills the processes that outlive their test and returns their names."""
    deadline = time.monotonic() + LEAVE_S
    while marked(mark) and time.monotonic() < deadline:
        time.sleep(0.02)
    processes = marked(mark)
    names = [f"{name_of(process)} ({process})" for process in processes]
    kill(processes)
    return names


def run(binary, prefix, limit_s):
    mark, start, reasons = f"{os.getpid()}:{binary}", time.monotonic(), []
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen([*prefix, str(binary.absolute())], stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                   start_new_session=True,
                                   env={**os.environ, MARK: mark, "CMOCKA_MESSAGE_OUTPUT": "STDOUT"})
        try:
            code = process.wait(limit_s)
        except subprocess.TimeoutExpired:
            reasons.append(f"took longer than {limit_s:g} s")
            os.killpg(process.pid, signal.SIGKILL)
            kill(marked(mark))
            code = process.wait()
        seconds = time.monotonic() - start
        if not reasons and (left := left_behind(mark)):
            reasons.append("left running: " + ", ".join(left))
        log.seek(0)
        output = log.read().decode(errors="replace")
    passed, failed, skipped = count(output)
    if not reasons and code < 0:
        reasons.append(f"ended by {signal.Signals(-code).name}")
    elif not reasons and code and not failed:
        reasons.append(f"exit code {code}")
    if not passed + failed + skipped:
        reasons.append("ran no test")
    return Outcome(binary, passed, max(failed, len(reasons)), skipped, seconds, "; ".join(reasons), output)


def show(outcome):
    name = "/".join(outcome.binary.parts[-2:])
    notes = [f"{outcome.skipped} skipped"] * bool(outcome.skipped) + [outcome.reason] * bool(outcome.reason)
    print(f"{'FAIL' if outcome.failed else 'ok':4}  {name:40} {outcome.passed:4} passed {outcome.failed:4} failed "
          f"{outcome.seconds:8.2f} s" + "".join(f"  {note}" for note in notes))
    if outcome.failed:
        print("".join(f"      | {line}\n" for line in outcome.output.splitlines()), end="")
    sys.stdout.flush()


def run_all(binaries, jobs, limit_s, under):
    isolated = isolation()
    with ThreadPoolExecutor(jobs or (2 if isolated else 1)) as pool:
        futures = [pool.submit(run, binary, isolated + under, limit_s) for binary in binaries]
        try:
            for future in as_completed(futures):
                show(future.result())
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            for binary in binaries:
                kill(marked(f"{os.getpid()}:{binary}"))
            raise
    return [future.result() for future in futures]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binaries", type=Path, nargs="*", metavar="BINARY")
    parser.add_argument("--jobs", type=int,
                        help="number of parallel binaries (default 2, or 1 where they would share a network)")
    parser.add_argument("--time-limit", type=float, default=600, metavar="S",
                        help="of each binary (default %(default)s)")
    parser.add_argument("--under", type=str.split, default=[], metavar="COMMAND",
                        help="command that runs the binaries, such as qemu")
    arguments = parser.parse_args()
    if missing := [binary for binary in arguments.binaries if not os.access(binary, os.X_OK)]:
        parser.error(f"not a program: {missing[0]}")
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup(1) ignores SIGHUP
            signal.signal(number, signal.default_int_handler)
    try:
        outcomes = run_all(arguments.binaries, arguments.jobs, arguments.time_limit, arguments.under)
    except KeyboardInterrupt:
        sys.exit(130)
    failed = sum(outcome.failed for outcome in outcomes)
    print(f"{sum(outcome.passed for outcome in outcomes)} passed, {failed} failed")
    sys.exit(1 if failed or not outcomes else 0)


if __name__ == "__main__":
    main()
