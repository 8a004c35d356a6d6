#!/usr/bin/env python3
"""Turn an LCM log of a run into one HTML page: verdict, 3-D recording and curves. It loads nothing when it is opened.

The log may come from build/sim --log, record.py or lcm-logger. The arms and their channels are those of the scenario
after which `make run` has named the log, else that of the LWA3; or one arm, that of --config.
"""
import argparse
import base64
import html
import string
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/view"))
import arm
import logs
import runs
from arm_view import ArmView
from errors import reason


def table(names, columns):
    """columns: [(name, text)] of each arm, with the same names."""
    rows = [[("th", name) for name in ("", *names)]] if len(names) > 1 else []
    rows += [[("th", row[0][0]), *(("td", text) for _, text in row)] for row in zip(*columns)]
    return "".join("<tr>" + "".join(f"<{tag}>{html.escape(text)}</{tag}>" for tag, text in row) for row in rows)


def curves(run, config, robot):
    import timeline  # matplotlib takes a second, and tests of the arguments do without it
    drawn = timeline.draw(run, arm.limits(*robot, arm.section(config, "limits")))
    title = f"<h2>{html.escape(run.name)}</h2>" if run.name else ""
    spans = " ".join(f"{number:.6g}" for number in (*drawn.span_s, *drawn.span))
    return (f'{title}<div class="curves" data-spans="{spans}"><img alt="curves over time" '
            f'src="data:image/svg+xml;base64,{base64.b64encode(drawn.svg).decode()}"><hr hidden></div>')


def page(log, robots):
    """The HTML. robots: configuration -> (URDF, base, tip) of each arm."""
    arms = [ArmView(config, robot, config.stem if len(robots) > 1 else "") for config, robot in robots.items()]
    if not log.is_file():
        raise logs.NoRun(f"{log}: {'a folder' if log.is_dir() else 'no such file'}")
    found = [logs.run_of(log, arms, one, config) for one, config in zip(arms, robots)]
    import panel
    import recording
    import verdict
    verdicts = [[("robot", arm.name(robots[config][0])), ("recorded", logs.date(log)),
                 *verdict.rows(run, log)] for run, config in zip(found, robots)]
    template = string.Template((Path(__file__).parent / "report.html").read_text())
    return template.substitute(
        title=html.escape(log.name), key=panel.key(),
        verdict=table([one.name for one in arms], verdicts),
        recording=html.escape(recording.page(log, arms, found[0].columns["t_s"][-1])),
        curves="\n".join(curves(run, *robot) for run, robot in zip(found, robots.items())))


def configs_for(log):
    """The configurations of the scenario after which the log is named, else that of the LWA3."""
    scenario_file = runs.ROOT / "host/scenarios" / f"{log.stem.removesuffix('-realtime')}.yaml"
    if not scenario_file.is_file():
        return [arm.CONFIG]
    return [runs.config_of(one) for one in runs.arms_of(runs.load_scenario(scenario_file))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, metavar="LOG")
    parser.add_argument("-o", "--output", type=Path, default=Path("report.html"),
                        help="page to write (default: %(default)s)")
    parser.add_argument("--config", type=Path,
                        help="configuration of the controller (default: those of the scenario after which LOG is "
                             "named, else that of the LWA3)")
    arm.add_robot(parser)
    arguments = parser.parse_args()
    try:
        configs = [arguments.config] if arguments.config else configs_for(arguments.log)
        robots = {config: arm.robot_of(config, arguments) for config in configs}
        arguments.output.write_text(page(arguments.log, robots))
    except (logs.NoRun, runs.RunFailed, OSError, ValueError) as error:
        sys.exit(f"report.py: {reason(error)}")
    print(f"wrote {arguments.output} ({arguments.output.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    runs.main_of(main)
