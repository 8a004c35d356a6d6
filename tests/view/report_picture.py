#!/usr/bin/env python3
"""Open the report of a run in headless Chromium.

It shows arm, obstacles and target, the time of the recording is marked in the curves, and it may reach no address.
"""
import time

import picture
from picture import LEAST_PIXELS, ROOT, runs

import report

FETCH = """const done = arguments[0];
document.addEventListener("securitypolicyviolation", event => done(event.effectiveDirective));
fetch("http://localhost:9").catch(() => setTimeout(() => done("nothing"), 1000));"""
MARK_OFF = """const slider = document.querySelector("iframe").contentDocument.querySelector("[role=slider]");
const curves = document.querySelector(".curves"), [from, to, left, right] = curves.dataset.spans.split(" ").map(Number);
const share = (slider.getAttribute("aria-valuenow") - from) / (to - from), line = curves.querySelector("hr");
return [line.hidden ? 1 : Math.abs(parseFloat(line.style.left) / 100 - left - share * (right - left)),
        line.style.left];"""


def marks(page, limit_s=20):
    """Two marks in the curves, while it plays: each how far it is from the player's time, and its place (widths)."""
    page.switch_to.default_content()
    deadline = time.monotonic() + limit_s
    first = second = page.execute_script(MARK_OFF)
    while second[1] == first[1] and time.monotonic() < deadline:
        time.sleep(0.5)
        second = page.execute_script(MARK_OFF)
    return [first, second]


def main():
    log, file = runs.RECORDS / "paper-c-view-test.lcmlog", runs.BUILD / "report-test.html"
    runs.execute(ROOT / "host/scenarios/paper-c.yaml", "sidestep", log.with_suffix(".csv"), lcm_url=runs.private_url(),
                 log=log)
    file.write_text(report.page(log, {report.arm.CONFIG: (ROOT / "urdf/lwa3.urdf", "base_link", "tool")}))
    page = picture.browser()
    try:
        page.get(file.as_uri())
        page.execute_script("document.querySelector('iframe').scrollIntoView()")
        page.switch_to.frame(0)
        image, counts = picture.photograph(page)
        loaded = page.execute_script("return performance.getEntriesByType('resource').map(entry => entry.name)")
        refused = page.execute_async_script(FETCH)
        marked = marks(page)
    finally:
        page.quit()
    output = runs.FIGURES / "report.png"
    output.parent.mkdir(parents=True, exist_ok=True)
    image.save(output, optimize=True)
    print(f"pixels in {runs.shown(output)}: {counts}; loaded: {loaded or 'nothing'}; refused: {refused}")
    follows = all(off < 1e-3 for off, _ in marked) and marked[0][1] != marked[1][1]
    passed = follows and not loaded and refused == "connect-src" and all(counts[name] >= least for name, least in
                                                             LEAST_PIXELS.items())
    print(f"marks in the curves: {marked}")
    print("report: " + ("arm, obstacles and target are in the picture, and no address can be reached" if passed
                        else "arm, obstacles, target or a mark in the curves are missing, or an address can be reached"))
    return 0 if passed else 1


if __name__ == "__main__":
    runs.main_of(main)
