#!/usr/bin/env python3
"""Open the report of a run in headless Chromium: it shows arm, obstacles and target, and may reach no address."""
import picture
from picture import LEAST_PIXELS, ROOT, runs

import report

FETCH = """const done = arguments[0];
document.addEventListener("securitypolicyviolation", event => done(event.effectiveDirective));
fetch("http://localhost:9").catch(() => setTimeout(() => done("nothing"), 1000));"""


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
    finally:
        page.quit()
    output = runs.FIGURES / "report.png"
    output.parent.mkdir(parents=True, exist_ok=True)
    image.save(output, optimize=True)
    print(f"pixels in {runs.shown(output)}: {counts}; loaded: {loaded or 'nothing'}; refused: {refused}")
    passed = not loaded and refused == "connect-src" and all(counts[name] >= least for name, least in
                                                             LEAST_PIXELS.items())
    print("report: " + ("arm, obstacles and target are in the picture, and no address can be reached" if passed
                        else "arm, obstacles or target are missing, or an address can be reached"))
    return 0 if passed else 1


if __name__ == "__main__":
    runs.main_of(main)
