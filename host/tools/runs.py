"""Runs of build/controller with build/sim, and the results that they record."""
import argparse
import csv
import random
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import environment
import numpy as np
import yaml

from errors import reason
from stop_signals import on_stop

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
FIGURES = BUILD / "figures"
RECORDS = BUILD / "runs"
LAWS = {"paper": "the paper's law", "sidestep": "Sidestep"}
TASK_LETTERS = 150
HELD, BROKEN = 0, 1  # exit codes of a completed simulation: its expectations were met, or not

stopping = threading.Event()


class RunFailed(Exception):
    """A process failed; the text is one line with the reason."""

    def __init__(self, text, code=2):
        super().__init__(text)
        self.code = code


class ControllerStopped(RunFailed):
    """An operator or a signal has stopped the controller before the end of the simulation."""


class Run(NamedTuple):
    name: str       # of the scenario's file, for two arms with the arm's name
    law: str
    scenario: dict
    columns: dict   # column name of the simulator's CSV -> array
    code: int       # exit code of the simulator: HELD or BROKEN
    others: tuple = ()  # the runs of the other arms of the scenario

    def family(self, pattern):
        """The columns whose names match, N x count, in the order of their numbers."""
        names = sorted((name for name in self.columns if re.fullmatch(pattern, name)),
                       key=lambda name: int(re.search(r"\d+", name)[0]))
        return np.stack([self.columns[name] for name in names], axis=1)

    def path(self, what):
        """N x 3, m, base frame: the positions of `tool`, `target`, `o1`, `guide1` ..."""
        return np.stack([self.columns[f"{what}_{axis}_m"] for axis in "xyz"], axis=1)

    def joints(self):
        """N x joints, rad."""
        return self.family(r"q\d+_rad")

    def touching(self):
        """Whether the arm touches an obstacle, another arm or itself, at every row."""
        others_m = np.minimum(self.columns["clearance_m"], self.columns["neighbour_clearance_m"])
        return (others_m < 0) | self.touching_itself()

    def touching_itself(self):
        """Whether two links of the arm touch each other, at every row."""
        return self.columns["self_clearance_m"] <= 0


def load(file):
    """A YAML file as a dict."""
    try:
        return yaml.safe_load(Path(file).read_text())
    except OSError as error:
        raise RunFailed(reason(error)) from None
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise RunFailed(f"{file}: {reason(error)}") from None


def scenario_names():
    return sorted(file.stem for file in (ROOT / "host/scenarios").glob("*.yaml"))


def ending_scenarios():
    """The names of the scenarios that end by themselves."""
    return [name for name in scenario_names() if "duration_s" in load(ROOT / f"host/scenarios/{name}.yaml")]


def check_ends(file, scenario):
    """RunFailed for a scenario that runs until it is interrupted."""
    if "duration_s" not in scenario:
        name = Path(file).stem
        raise RunFailed(f"{name} has no end: make play, or make view SCENARIO={name}")


def load_scenario(file):
    """A scenario. Only the keys that the scripts use are checked; the simulator checks the others."""
    if not Path(file).is_file():
        raise RunFailed(f"{shown(Path(file))}: no such scenario; there are {', '.join(scenario_names())}")
    scenario = load(file)
    check(file, scenario, title=str)
    if "duration_s" in scenario:
        check(file, scenario, duration_s=(int, float))
    if "arms" in scenario:
        check(file, scenario, arms=list)
    scenario["task"] = task_of(Path(file).read_text())
    if "people" in scenario:
        scenario["obstacles"] = obstacles_of(file, scenario)
    for arm in scenario.get("arms", [scenario]):
        check(file, arm, config=str, robot=dict, **({"name": str} if "arms" in scenario else {}))
    return scenario


def task_of(text):
    """What a scenario is about: the whole sentences of its first comment that fit into a line of a figure."""
    comment = re.match(r"(#[^\n]*\n)*", text)[0].replace("\n#", "").lstrip("# ")
    task = ""
    for sentence in re.findall(r".+?\.(?=\s|$)", comment.strip()):
        if len(task + sentence) > TASK_LETTERS:
            break
        task += sentence
    return task


def obstacles_of(file, scenario):
    """The list `obstacles` of a scenario, followed by the parts of its people without motion; `body` names the person."""
    listed = subprocess.run([BUILD / "sim", "--scenario", file, "--list-obstacles"], capture_output=True, text=True)
    if listed.returncode:
        raise RunFailed(listed.stderr.strip())
    own, people = scenario.get("obstacles") or [], scenario["people"]
    parts = yaml.safe_load(listed.stdout)[len(own):]
    for i, part in enumerate(parts):
        number = i * len(people) // len(parts)
        part["body"] = "person" if len(people) == 1 else f"person {number + 1}"
    return own + parts


def check(file, section, **kinds):
    for key, kind in kinds.items():
        if not isinstance(section, dict) or not isinstance(section.get(key), kind) or not section[key]:
            raise RunFailed(f"{file}: {key} is missing, empty or of the wrong type")


def arms_of(scenario):
    """One scenario for each arm; for a single arm the scenario itself."""
    return [scenario | arm | {"title": f"{scenario['title']}: {arm['name']}"} for arm in scenario.get("arms", [])] or [
        scenario]


def file_of(arm, file):
    """The file for one arm: of several arms each has its own, with the arm's name before the suffix."""
    return file.with_stem(f"{file.stem}-{arm['name']}") if "name" in arm else file


def verdict_file(log):
    """The file beside a log that says whether the run met the scenario's expectations."""
    return log.with_suffix(".verdict")


def config_of(scenario):
    return ROOT / scenario["config"]


def read_csv(file):
    """Column name -> array; empty for a file without a whole row of numbers."""
    with open(file, newline="") as stream:
        names, *rows = [*csv.reader(stream)] or [[]]
    columns = zip(*(row for row in rows if len(row) == len(names)))
    return {name: numeric(column) for name, column in zip(names, columns)}


def numeric(column):
    try:
        return np.array(column, float)
    except ValueError:
        return np.array(column)


claims = []  # sockets without a file whose names are ports: no other process can have one of them


def private_url():
    """An LCM network on this machine only, on a port that no other run has until this process ends."""
    while True:
        port = random.randint(20000, 32000)
        claim = socket.socket(socket.AF_UNIX)
        try:
            claim.bind(f"\0sidestep-{port}")
        except OSError:
            claim.close()
            continue
        claims.append(claim)
        return f"udpm://239.255.76.67:{port}?ttl=0"


def start(command, output):
    program = Path(command[0])
    if not program.exists():
        raise RunFailed(f"{program.relative_to(ROOT)} is missing: run make")
    # In its own process group: Ctrl-C reaches this script only, which then stops the processes in order.
    return subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=output, stderr=output,
                            cwd=ROOT, process_group=0)


def stop(process):
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(3)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    return process.returncode


def ending(code):
    return f"ended with exit code {code}" if code >= 0 else f"was terminated by {signal.Signals(-code).name}"


def last_line(log):
    lines = log.read_text(errors="replace").split("\n") if log.exists() else []
    return next((line.strip() for line in reversed(lines) if line.strip()), "no output")


def wait(processes, limit_s):
    """Returns when one of the processes has ended."""
    deadline = time.monotonic() + limit_s
    while all(process.poll() is None for process in processes.values()):
        if stopping.is_set():
            raise KeyboardInterrupt
        if time.monotonic() > deadline:
            raise RunFailed(f"build/sim is not finished after {limit_s:.0f} s")
        time.sleep(0.005)


@contextmanager
def signals_as_flag():
    """Within the block a signal raises no exception but sets `stopping`, which wait() obeys; then KeyboardInterrupt.

    An exception inside of Popen.poll() leaves its lock taken, and whoever then waits for the process waits for ever.
    """
    if threading.current_thread() is not threading.main_thread():  # only there signals raise exceptions
        yield
        return
    handlers = on_stop(lambda *_: stopping.set())
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        if stopping.is_set():
            stopping.clear()
            interrupt()


def execute(scenario_file, law, record, config=None, lcm_url="", lockstep=True, log=None, viewer=None):
    """Run one simulation to its end, write the CSV `record` and return the simulator's exit code (HELD or BROKEN).

    In real time (lockstep=False) the simulator writes to this terminal. It records all messages in `log`, beside which
    is then its verdict. When the process `viewer` ends, so does the simulation, and None is returned. RunFailed if a
    process fails.
    """
    scenario = load_scenario(scenario_file)
    if lockstep:
        check_ends(scenario_file, scenario)
    if log:
        verdict_file(log).unlink(missing_ok=True)
    record.parent.mkdir(parents=True, exist_ok=True)
    common = ["--lockstep"] * lockstep + (["--lcm-url", lcm_url] if lcm_url else [])
    commands = {f"controller-{arm['name']}" if "name" in arm else "controller":
                [BUILD / "controller", "--config", config or config_of(arm), "--law", law, *common]
                for arm in arms_of(scenario)}
    commands["sim"] = [BUILD / "sim", "--scenario", scenario_file, "--csv", record,
                       *(["--log", log] if log else []), *common]
    logs = {name: record.with_suffix(f".{name}.log") for name in commands}
    processes = {}
    with signals_as_flag():
        try:
            for name, command in commands.items():
                with open(logs[name], "w") as output:
                    processes[name] = start(command, output if lockstep or name != "sim" else None)
            watched = processes | ({"viewer": viewer} if viewer else {})
            wait(watched, scenario.get("duration_s", np.inf) * (10 if lockstep else 1) + 60)
            lost = {name for name, process in processes.items() if name != "sim" and process.poll() is not None}
        finally:
            codes = {name: stop(process) for name, process in reversed(processes.items())}
    if viewer and viewer.poll() is not None:
        return None
    sim = codes.pop("sim")
    if not lost and sim not in (HELD, BROKEN):
        reason = f": {last_line(logs['sim'])}" if lockstep else ""
        raise RunFailed(f"build/sim {ending(sim)}{reason}", sim)
    for name, code in codes.items():
        if code:
            raise RunFailed(f"build/controller {ending(code)}: {last_line(logs[name])}")
    if lost:
        raise ControllerStopped("the controller was stopped, by control.py or a signal")
    if log:
        verdict_file(log).write_text("met" if sim == HELD else "not met")
    return sim


def lockstep_runs(scenario_file, law, record, config=None):
    """One run in lockstep on its own LCM network. Returns a Run for each arm."""
    code = execute(scenario_file, law, record, config, private_url())
    runs = [Run(file_of(arm, Path(scenario_file)).stem, law, arm, read_csv(file_of(arm, record)), code)
            for arm in arms_of(load_scenario(scenario_file))]
    return [run._replace(others=tuple(other for other in runs if other is not run)) for run in runs]


def lockstep_run(scenario_file, law, record, config=None):
    """lockstep_runs() of a scenario with one arm."""
    return lockstep_runs(scenario_file, law, record, config)[0]


def in_parallel(function, jobs, workers=2, done=lambda count, total: None):
    """[function(*job) for job in jobs], `workers` at a time. Calls done(finished, total). Ctrl-C ends all of them."""
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(function, *job) for job in jobs]
        try:
            for count, future in enumerate(as_completed(futures), 1):
                future.result()
                done(count, len(jobs))
        except BaseException:
            stopping.set()
            pool.shutdown(cancel_futures=True)
            stopping.clear()
            raise
    return [future.result() for future in futures]


def seconds(text):
    """A duration on the command line: a whole number from 1, s."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' must be a whole number from 1")
    return int(text)


def interrupt(*_):
    """Ends the script once: a second signal, as of make or of an impatient hand, does not interrupt the clean-up."""
    on_stop(lambda *_: None)
    raise KeyboardInterrupt


def main_of(script):
    """Run a script's main function and exit with its return value. Signals (stop_signals.py) stop its processes."""
    on_stop(interrupt)
    try:
        sys.exit(script())
    except RunFailed as failure:
        print(f"\n{Path(sys.argv[0]).name}: {failure}", file=sys.stderr)
        sys.exit(failure.code if failure.code > 0 else 2)
    except KeyboardInterrupt:
        print("\nstopped")
        sys.exit(130)


def progress(text):
    """A progress bar for in_parallel's `done`."""
    def done(count, total):
        if sys.stdout.isatty() or count == total:
            bar = "#" * (30 * count // total)
            print(f"\r{text} [{bar:30}] {count}/{total}", end="\n" if count == total else "", flush=True)
    return done


def shown(path):
    """The path relative to the project, if it lies in the project."""
    return str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)
