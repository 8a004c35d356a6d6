"""Wake-up latencies of the controller, as it prints them at exit, and of cyclictest on the same machine."""
import os
import re
import subprocess
from typing import NamedTuple

import runs

PRIORITY = 80  # FIFO priority, equal to that of the controller's loop
LONGEST_US = 20_000  # last bin of cyclictest's histogram; cyclictest also reports the worst latency beyond it


class Latency(NamedTuple):
    p50_us: float
    p99_us: float
    p999_us: float
    worst_us: float
    count: int


class Loop(NamedTuple):
    cycles: int
    skipped: int
    wake_up: Latency
    cpu_worst_us: float
    fifo: bool


def loop_of(log):
    """The timing that the controller printed at exit."""
    text = log.read_text(errors="replace")
    ended = re.search(r"(\d+) cycles, (\d+) skipped", text)
    rows = {name: [float(value) for value in values.split()]
            for name, values in re.findall(r"^(wake-up latency|CPU time, cycle)((?: +[\d.]+){4})$", text, re.M)}
    if not ended or len(rows) < 2:
        raise runs.RunFailed(f"build/controller printed no timing: {runs.last_line(log)}")
    cycles, skipped = map(int, ended.groups())
    return Loop(cycles, skipped, Latency(*rows["wake-up latency"], cycles), rows["CPU time, cycle"][3],
                "is not permitted" not in text)


def start_cyclictest(interval_us, duration_s, threads, output):
    """cyclictest with FIFO scheduling, or None if not permitted. Several threads are pinned to one CPU each."""
    probe = subprocess.run(["cyclictest", "-q", "-l", "1", "-p", str(PRIORITY)], capture_output=True)
    if probe.returncode:
        return None
    command = ["cyclictest", "-q", "-m", "-p", str(PRIORITY), "-i", str(interval_us), "-D", str(int(duration_s)),
               "-h", str(LONGEST_US), *(["-a", "-t", str(threads)] if threads > 1 else ["-t", "1"])]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, process_group=0)


def histogram_of(log):
    """({latency in us: count}, worst latency in us) over all threads of cyclictest."""
    text = log.read_text(errors="replace")
    bins = {int(us): sum(map(int, counts.split()))
            for us, counts in re.findall(r"^(\d{6}) ((?:\d{6}\s*?)+)$", text, re.M)}
    worst = re.search(r"# Max Latencies: ([\d ]+)", text)
    if not worst:
        raise runs.RunFailed(f"cyclictest printed no histogram: {runs.last_line(log)}")
    beyond = sum(map(int, re.search(r"# Histogram Overflows: ([\d ]+)", text)[1].split()))
    worst_us = max(map(int, worst[1].split()))
    return {**bins, **({worst_us: beyond} if beyond else {})}, worst_us


def cyclictest_of(log):
    bins, worst_us = histogram_of(log)
    total = sum(bins.values())

    def quantile(share):
        count = 0
        for us in sorted(bins):
            count += bins[us]
            if count >= share * total:
                return us
        return worst_us

    return Latency(quantile(0.5), quantile(0.99), quantile(0.999), worst_us, total)


def busy_loops():
    """One process with an endless loop for each CPU."""
    return [subprocess.Popen(["sh", "-c", "while :; do :; done"], process_group=0) for _ in range(os.cpu_count())]
