#!/usr/bin/env python3
"""Checks of what README.md shows: the moving picture and the Python example. A failed check ends with an assertion."""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/tools"))
import animation
import docs
import plots
import runs
import wire


def moving_picture():
    """A moving picture says what the run did, lasts as long as the run, and carries the numbers that are in it."""
    scenario_file = ROOT / "host/scenarios/closing-gap.yaml"
    with tempfile.TemporaryDirectory() as name:
        both = runs.in_parallel(runs.lockstep_run, [(scenario_file, law, Path(name) / f"{law}.csv")
                                                    for law in runs.LAWS])
        short = [run._replace(columns={key: values[:25] for key, values in run.columns.items()}) for run in both]
        picture = animation.save(short, Path(name) / "short.gif")
        assert docs.numbers_of(picture) == plots.numbers(short)
        image, shown_ms = Image.open(picture), 0
        for frame in range(image.n_frames):
            image.seek(frame)
            shown_ms += image.info["duration"]
    assert image.n_frames > 2 and abs(shown_ms - 240 - animation.HOLD_S * 1000) <= 80, shown_ms
    for run, row, texts in ((both[0], 0, ("clearance 141 mm", "target 979 mm away")),
                            (both[0], int(np.argmin(both[0].columns["clearance_m"])), ("CONTACT, ", "away")),
                            (both[0], 800, ("CONTACT at ", "away")),
                            (both[1], 800, ("no contact, least clearance ", "target reached"))):
        said = [text for text, _ in animation.words(run, row)]
        assert all(part in text for part, text in zip(texts, said)), (row, said)


def example():
    """The Python example of README.md sends the target and the obstacle that it shows."""
    network = runs.private_url()
    latest = wire.LatestMessages(["TARGET", "OBSTACLES"], network)
    code = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)[1]
    assert len(code.splitlines()) == 10, code
    sender = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {
        "LCM_DEFAULT_URL": network, "PYTHONPATH": str(ROOT / "build/lcm/python")})
    deadline = time.monotonic() + 20
    while not {"TARGET", "OBSTACLES"} <= latest.keys() and time.monotonic() < deadline:
        latest.receive(0.1)
    sender.kill()
    sender.wait()
    (ball,) = latest["OBSTACLES"].obstacles
    assert list(latest["TARGET"].position) == [-0.5, -0.3, 0.5] and ball.shape == ball.SPHERE and ball.size[0] == 0.05


CHECKS = {check.__name__: check for check in (moving_picture, example)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("check", choices=CHECKS)
    CHECKS[parser.parse_args().check]()
