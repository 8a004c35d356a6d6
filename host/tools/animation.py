#!/usr/bin/env python3
"""Draw a scenario as a moving picture: both laws side by side in real time, with clearance and contact in words.

The runs are in lockstep, so that the same version draws the same picture. It is an animated GIF.
"""
import argparse
from pathlib import Path

import environment
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import drawing
import outcome
import plots
import runs
import solids
import style
from runs import LAWS
from solids import in_world

VIEW = solids.View(-80, 28)
FRAME_S, HOLD_S = 0.08, 2.0  # the last frame stays for HOLD_S
COLOURS = 64
NEAR_M = 0.6     # obstacles within this clearance are in the picture
ARROW_M = 0.16
RED, OBSTACLE = style.CONTACT, "#77808C"


def rows_of(run):
    """The rows that are drawn, the last one included."""
    t = run.columns["t_s"]
    return np.searchsorted(t, np.append(np.arange(t[0], t[-1] - FRAME_S / 2, FRAME_S), t[-1]))


def limits(both):
    """Lower and upper corner of the picture, m: all that the arms reach, and the obstacles near them."""
    points = []
    for run in both:
        for row in rows_of(run)[::5]:
            near = [one for i, one in enumerate(solids.obstacle_solids(run, row))
                    if run.columns[f"o{i + 1}_clearance_m"][row] < NEAR_M]
            points += [solids.surface(one) for one in solids.arm_solids(run, row) + near]
    flat = VIEW.flat(np.concatenate(points))
    return flat.min(axis=0) - 0.05, flat.max(axis=0) + 0.05


def words(run, row):
    """(text, colour) of the two lines below a panel: clearance or contact, and the distance to the target."""
    t, clearance_m, distance_m = run.columns["t_s"], outcome.clearance(run), run.columns["target_distance_m"][row]
    touching = np.flatnonzero(clearance_m[:row + 1] < 0)
    if clearance_m[row] < 0:
        first = f"CONTACT, {-clearance_m[row] * 1000:.0f} mm deep", RED
    elif touching.size:
        first = f"CONTACT at {t[touching[0]]:.1f} s", RED
    elif not np.isfinite(clearance_m[row]):
        first = "no obstacles", "black"
    elif row == len(t) - 1:
        first = f"no contact, least clearance {clearance_m.min() * 1000:.0f} mm", "black"
    else:
        first = f"clearance {clearance_m[row] * 1000:.0f} mm", "black"
    arrived = distance_m < outcome.ARRIVED_M
    return first, (f"target {'reached' if arrived else f'{distance_m * 1000:.0f} mm away'}",
                   style.TARGET if arrived else "0.35")


def draw_obstacles(painter, run, row):
    """Obstacles at a row, with an arrow in the direction in which they move."""
    for i, one in enumerate(solids.obstacle_solids(run, row)):
        painter.solid(one, OBSTACLE, 0.95)
        centres = in_world(run.scenario, run.path(f"o{i + 1}")[[max(row - 5, 0), min(row + 5, len(run.joints()) - 1)]])
        start, end = painter.view.flat(centres)
        if np.linalg.norm(end - start) > 1e-3:
            middle = painter.view.flat(one.position)
            tip = middle + (end - start) / np.linalg.norm(end - start) * ARROW_M
            painter.axes.annotate("", tip, middle, zorder=5, annotation_clip=True,
                                  arrowprops=dict(arrowstyle="-|>", color="black", linewidth=2, mutation_scale=18))


def draw_scene(painter, run, row, touching):
    colour = style.LAW_COLOURS[run.law]
    drawing.draw_floor(painter, run)
    for one in solids.surroundings(run):
        painter.solid(one, "0.75", 0.35, behind=True)
    draw_obstacles(painter, run, row)
    for other in run.others:
        drawing.draw_arm(painter, other, row, style.OTHER_ARM, 1.0, None)
    drawing.draw_arm(painter, run, row, RED if touching else colour, 1.0, None)
    painter.line(in_world(run.scenario, run.path("tool")[:row + 1]), color=colour, linewidth=1.2, zorder=6)
    painter.line(in_world(run.scenario, run.path("target")[[row]]), color=style.TARGET, marker="*", markersize=18,
                 markeredgecolor="white", zorder=9)
    if touching and (pair := outcome.nearest(run, row, outcome.clearance(run)[row])[1]):
        drawing.mark_contact(painter, pair)
    painter.finish()


def draw(axes, run, row, corners):
    law = LAWS[run.law]
    draw_scene(drawing.Painter(axes, VIEW), run, row, outcome.clearance(run)[row] < 0)
    axes.set(xlim=(corners[0][0], corners[1][0]), ylim=(corners[0][1], corners[1][1]))
    axes.set_axis_off()
    axes.set_title(law[0].upper() + law[1:], loc="center", fontsize=15, fontweight="bold",
                   color=style.LAW_COLOURS[run.law])
    for line, (text, colour) in enumerate(words(run, row)):
        axes.text(0.5, -0.01 - 0.085 * line, text, transform=axes.transAxes, ha="center", va="top", fontsize=14,
                  color=colour, fontweight="bold" if colour == RED else "normal")


def frames(both):
    """An RGB image of every drawn row."""
    corners = limits(both)
    figure, panels = plt.subplots(1, 2, figsize=(9, 4.5), dpi=100)
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.17, top=0.84, wspace=0.04)
    title, drawn = figure.suptitle("", fontsize=13), []
    for row in rows_of(both[0]):
        t_s = both[0].columns["t_s"][row]
        title.set_text(f"{both[0].scenario['title']}: the tool has to reach the star. {t_s:.1f} s")
        for axes, run in zip(panels, both):
            axes.clear()
            draw(axes, run, row, corners)
        figure.canvas.draw()
        drawn.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3]))
    plt.close(figure)
    return drawn


def save(both, file):
    """Writes the moving picture of [paper's run, sidestep's run], with plots.numbers() as its comment."""
    images = frames(both)
    # One palette for all frames, made from nine of them.
    sample = np.concatenate([np.asarray(images[i]) for i in np.linspace(0, len(images) - 1, 9).astype(int)])
    palette = Image.fromarray(sample).quantize(COLOURS)
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    durations_ms = [round(FRAME_S * 1000)] * (len(images) - 1) + [round(HOLD_S * 1000)]
    file.parent.mkdir(parents=True, exist_ok=True)
    images[0].save(file, save_all=True, append_images=images[1:], duration=durations_ms, loop=0,
                   comment="\n".join(plots.numbers(both)))
    return file


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, metavar="SCENARIO", help="a scenario's YAML; of several arms the first")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE",
                        help="animated GIF (default: build/figures/NAME.gif)")
    arguments = parser.parse_args()
    name = arguments.scenario.stem
    both = runs.in_parallel(runs.lockstep_run, [(arguments.scenario.absolute(), law, runs.RECORDS / f"{name}-{law}.csv")
                                                for law in LAWS])
    print(f"wrote {runs.shown(save(both, arguments.output or runs.FIGURES / f'{name}.gif'))}")


if __name__ == "__main__":
    runs.main_of(main)
