#!/usr/bin/env python3
"""Show a run in headless Chromium and check that the picture contains arm, obstacles and target."""
import argparse
import io
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from selenium import webdriver
from selenium.common.exceptions import WebDriverException

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "host/tools"), str(ROOT / "host/view")]
import docs
import panel
import runs
import show

PORT = 7070
PLAY = ROOT / "host/scenarios/play.yaml"
SCENE = (0, 0, 760, 560)  # px, the section of the screenshot without the panel, whose key has the same colours
SETTLE_S = 3.0  # until the page is drawn
LEAST_PIXELS = {"arm": 4000, "obstacles": 1500, "target": 60}
TARGET = ["-0.4", "-0.1", "0.6", "--circle", "0.3"]
OBSTACLES = ["0.5,-0.35,0.75,0.1,-0.06,0,0", "-0.35,0.75,0.8,0.12,0,-0.06,0", "0.4,0.2,0.3,0.12,0,0,0"]
HUES_DEG = {"arm": [(200, 230), (15, 65)], "obstacles": [(290, 325)], "target": [(135, 165)]}
FLAGS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--window-size=1100,800", "--hide-scrollbars"]


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for flag in FLAGS:
        options.add_argument(flag)
    return webdriver.Chrome(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))


def pixels(image):
    """The number of saturated pixels in the hues of each object."""
    hue, saturation, value = np.moveaxis(np.array(image.crop(SCENE).convert("HSV"), float), 2, 0)
    clear, degrees = (saturation > 100) & (value > 60), hue * 360 / 255
    return {name: int(sum((clear & (degrees > low) & (degrees < high)).sum() for low, high in ranges))
            for name, ranges in HUES_DEG.items()}


def close_notes(page):
    """Hides the browser's note that it draws without a GPU."""
    page.execute_script("document.querySelectorAll('.mantine-Notifications-root').forEach(note => note.remove())")


def photograph(page, limit_s=40):
    """(screenshot, pixel counts) of the first complete picture, or of the last one before the limit."""
    close_notes(page)
    deadline = time.monotonic() + limit_s
    while True:
        image = Image.open(io.BytesIO(page.get_screenshot_as_png())).convert("RGB")
        counts = pixels(image)
        if all(counts[name] >= least for name, least in LEAST_PIXELS.items()) or time.monotonic() > deadline:
            return image, counts


@contextmanager
def programs(scenario_file, scenario, url, senders):
    """Controller, simulator and senders (a script of host/tools with its arguments each) while the block runs."""
    started = [runs.start([*command, "--lcm-url", url], subprocess.DEVNULL) for command in (
        [runs.BUILD / "controller", "--config", runs.config_of(scenario)],
        [runs.BUILD / "sim", "--scenario", scenario_file, "--quiet"],
        *([sys.executable, f"host/tools/{script}", *words] for script, *words in senders))]
    try:
        yield
    finally:
        for program in reversed(started):
            runs.stop(program)


def open_page(page, query="", limit_s=30):
    """Opens the page, once the view serves it."""
    deadline = time.monotonic() + limit_s
    while True:
        try:
            page.get(f"http://localhost:{PORT}/{query}")
            return
        except WebDriverException:
            pass
        if time.monotonic() > deadline:
            raise runs.RunFailed(f"the view serves no page: {runs.last_line(runs.RECORDS / 'view.log')}")
        time.sleep(0.2)


def foreign_addresses(page):
    """What the page has loaded from elsewhere: it must work without internet."""
    names = page.execute_script("return performance.getEntriesByType('resource').map(entry => entry.name)")
    return [name for name in names if not name.startswith((f"http://localhost:{PORT}/", "data:", "blob:"))]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=runs.FIGURES / "view.png")
    output = parser.parse_args().output
    scenario, url = runs.load_scenario(PLAY), runs.private_url()
    with show.viewer(scenario, PORT, url):
        page = browser()
        try:
            open_page(page, "?fixedDpr=1")
            time.sleep(SETTLE_S)
            close_notes(page)
            empty = pixels(Image.open(io.BytesIO(page.get_screenshot_as_png())))
            with programs(PLAY, scenario, url, [["send_target.py", *TARGET], ["send_obstacles.py", *OBSTACLES]]):
                time.sleep(SETTLE_S)
                image, counts = photograph(page)
                foreign = foreign_addresses(page)
        finally:
            page.quit()
    output.parent.mkdir(parents=True, exist_ok=True)
    words = PngInfo()
    words.add_text(docs.KEY, panel.key())
    image.save(output, optimize=True, pnginfo=words)
    print(f"pixels before: {empty}; in {runs.shown(output.absolute())}: {counts}")
    print(f"loaded from elsewhere: {foreign or 'nothing'}")
    passed = not foreign and all(empty[name] < least <= counts[name] for name, least in LEAST_PIXELS.items())
    print("view: arm, obstacles and target are in the picture" if passed
          else "view: arm, obstacles or target are missing, or were in the picture before the run")
    return 0 if passed else 1


if __name__ == "__main__":
    runs.main_of(main)
