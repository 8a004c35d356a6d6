#!/usr/bin/env python3
"""Show a run in headless Chromium through Meldis and check that the picture contains arm, obstacles and target."""
import argparse
import io
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from PIL import Image
from selenium import webdriver
from selenium.common.exceptions import WebDriverException

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "host/tools"), str(ROOT / "host/view")]
import runs
import show

PORT = 7070
FRAME = (300, 120, 760, 520)  # px, the section of the screenshot that is saved
CAMERA_M = [0.75, 1.0, 1.2]  # x, y up, z towards the viewer: the browser's axes
LOOK_AT_M = [0.05, 0.6, 0.0]
LEAST_PIXELS = {"arm": 4000, "obstacles": 1500, "target": 60}
HUES_DEG = {"arm": [(200, 230), (15, 65)], "obstacles": [(290, 325)], "target": [(135, 165)]}
FLAGS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--window-size=1000,800", "--hide-scrollbars"]


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for flag in FLAGS:
        options.add_argument(flag)
    return webdriver.Chrome(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))


def aim(page):
    """Points the camera at the arm and hides the page's controls and grid."""
    for path, name, value in ((["Cameras", "default", "rotated", "<object>"], "position", CAMERA_M),
                              (["Grid"], "visible", False), (["Axes"], "visible", False)):
        page.execute_script("viewer.set_property(...arguments)", path, name, value)
    page.execute_script("viewer.set_camera_target(arguments[0])", LOOK_AT_M)
    page.execute_script("document.querySelectorAll('body > div:not(#meshcat-pane), .lil-gui, .dg')"
                        ".forEach(element => element.style.display = 'none')")


def pixels(image):
    """The number of saturated pixels in the hues of each object."""
    hue, saturation, value = np.moveaxis(np.array(image.convert("HSV"), float), 2, 0)
    clear, degrees = (saturation > 100) & (value > 60), hue * 360 / 255
    return {name: int(sum((clear & (degrees > low) & (degrees < high)).sum() for low, high in ranges))
            for name, ranges in HUES_DEG.items()}


def photograph(page, limit_s=40):
    """(screenshot, pixel counts) of the first complete picture, or of the last one before the limit."""
    deadline = time.monotonic() + limit_s
    while True:
        image = Image.open(io.BytesIO(page.get_screenshot_as_png())).convert("RGB")
        counts = pixels(image)
        if all(counts[name] >= least for name, least in LEAST_PIXELS.items()) or time.monotonic() > deadline:
            return image, counts


def open_page(page, limit_s=30):
    """Opens the page. Meldis needs some seconds until it serves it."""
    deadline = time.monotonic() + limit_s
    while True:
        try:
            page.get(f"http://localhost:{PORT}")
            if page.execute_script("return typeof viewer !== 'undefined'"):
                return
        except WebDriverException:
            pass
        if time.monotonic() > deadline:
            raise runs.RunFailed("Meldis serves no page")
        time.sleep(0.5)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=runs.FIGURES / "view.png")
    output = parser.parse_args().output
    scenario_file, url = ROOT / "host/scenarios/paper-c.yaml", runs.private_url()
    network = ["--lcm-url", url]
    with show.viewers(runs.load_scenario(scenario_file), PORT, url):
        page = browser()
        try:
            open_page(page)
            aim(page)
            empty = pixels(Image.open(io.BytesIO(page.get_screenshot_as_png())))
            programs = [runs.start([runs.BUILD / "controller", "--config", "firmware/config/lwa3.yaml", *network],
                                   subprocess.DEVNULL),
                        runs.start([runs.BUILD / "sim", "--scenario", scenario_file, "--quiet", *network],
                                   subprocess.DEVNULL)]
            try:
                image, counts = photograph(page)
            finally:
                for program in reversed(programs):
                    runs.stop(program)
        finally:
            page.quit()
    output.parent.mkdir(parents=True, exist_ok=True)
    image.crop(FRAME).save(output, optimize=True)
    print(f"pixels before: {empty}; in {runs.shown(output.absolute())}: {counts}")
    passed = all(empty[name] < least <= counts[name] for name, least in LEAST_PIXELS.items())
    print("view: arm, obstacles and target are in the picture" if passed
          else "view: arm, obstacles or target are missing, or were in the picture before the run")
    return 0 if passed else 1


if __name__ == "__main__":
    runs.main_of(main)
