#!/usr/bin/env python3
"""Count how often the view sends and a browser without a GPU draws, with 20 moving obstacles, on one machine.

The browser is headless Chromium, to which the view must have given its lower resolution. Fails below LEAST_SENT_HZ or
LEAST_DRAWN_HZ, or when the controller skips more than one cycle in a thousand. What is drawn depends on what else the
machine does, so the best of up to TRIES measurements counts.
"""
import argparse
import io
import multiprocessing
import os
import time
from contextlib import redirect_stdout
from pathlib import Path

import picture
from picture import ROOT, runs, show

import resolution
import view
import wire
from arm_view import ArmView

LEAST_SENT_HZ, LEAST_DRAWN_HZ, MOST_SKIPPED = 29.5, 30, 1e-3
TRIES = 3
SETTLE_S = 4.0
COUNT_FRAMES = """const [duration_s, done] = arguments, end = performance.now() + 1000 * duration_s;
let frames = 0;
(function draw() { frames++; performance.now() < end ? requestAnimationFrame(draw) : done(frames); })();"""
PIXELS = """return Math.max(...[...document.querySelectorAll("canvas")].map(canvas => canvas.width * canvas.height));"""
SENDERS = [["send_target.py", *picture.TARGET], ["send_obstacles.py", "--random", "20"]]


def run_view(scenario, url, sent):
    """In a process of its own: a view as show.viewer starts it, which counts its updates in `sent`."""
    class Counting(view.View):
        def draw(self):
            super().draw()
            sent.value += 1
    os.nice(int(show.NICE))
    robot = scenario["robot"]
    one = ArmView(runs.config_of(scenario), (ROOT / robot["urdf"], robot["base"], robot["tip"]))
    with redirect_stdout(io.StringIO()):  # the library prints its address
        counting = Counting([one], url, picture.PORT, steers=False)
    counting.run()


def skipped_cycles(latest):
    latest.receive(0.5)
    return latest["CONTROLLER_STATUS"].skipped_cycles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", type=Path, default=picture.PLAY, help="of one arm, without end (default: play)")
    parser.add_argument("--duration", type=float, default=10.0, metavar="SECONDS", help="(default %(default)s)")
    arguments = parser.parse_args()
    url, sent = runs.private_url(), multiprocessing.Value("q", 0)
    scenario = runs.load_scenario(arguments.scenario)
    process = multiprocessing.Process(target=run_view, args=(scenario, url, sent), daemon=True)
    process.start()
    page = picture.browser()
    try:
        picture.open_page(page)
        with picture.programs(arguments.scenario, scenario, url, SENDERS):
            time.sleep(SETTLE_S)
            page.set_script_timeout(arguments.duration + 30)
            latest = wire.LatestMessages({"CONTROLLER_STATUS": "CONTROLLER_STATUS"}, url)
            skipped, before, start_s = skipped_cycles(latest), sent.value, time.monotonic()
            drawn_hz = []
            while len(drawn_hz) < TRIES and max(drawn_hz, default=0) < LEAST_DRAWN_HZ:
                drawn_hz.append(page.execute_async_script(COUNT_FRAMES, arguments.duration) / arguments.duration)
            pixels = page.execute_script(PIXELS)
            sent_hz = (sent.value - before) / (time.monotonic() - start_s)
            skipped = skipped_cycles(latest) - skipped
    finally:
        page.quit()
        process.kill()
    cycles = len(drawn_hz) * arguments.duration * scenario["rate_hz"]
    print(f"view: {sent_hz:.1f} updates/s sent (at least {LEAST_SENT_HZ}), {max(drawn_hz):.1f} frames/s drawn (at "
          f"least {LEAST_DRAWN_HZ}) of {pixels} pixels, {skipped} of {cycles:.0f} cycles skipped; "
          f"load {os.getloadavg()[0]:.1f}")
    adapts = 0 < pixels <= resolution.SOFTWARE_PIXELS
    holds = sent_hz >= LEAST_SENT_HZ and max(drawn_hz) >= LEAST_DRAWN_HZ
    return 0 if adapts and holds and skipped <= MOST_SKIPPED * cycles else 1


if __name__ == "__main__":
    runs.main_of(main)
