"""The panel of the page: the controllers' state in words, the key of the colours, the layers, and steering by mouse."""
import html
import time

import watch
import wire
from scene import ARROW_S, BANDS, GUIDE, MOVING, NEAREST, RESTING, TARGET, TRAIL, UNKNOWN
from stage import Layers

STYLE = "<div style='font-size:0.85em;padding:0 1em'>"
DIRECT = "direct: the law alone arrives"


def key():
    """The meaning of the colours as HTML."""
    bounds = ["0", *(f"{most_m:g}" for most_m, _ in BANDS[:-1])]
    rows = [(colour, f"link, clearance {low} to {most_m:g} m") for low, (most_m, colour) in zip(bounds, BANDS[:-1])]
    rows += [(BANDS[-1][1], f"link, clearance above {bounds[-1]} m"),
             (UNKNOWN, "link, clearance unknown"),
             (MOVING, f"moving obstacle; arrow: {ARROW_S:g} s ahead"), (RESTING, "obstacle at rest, surroundings"),
             (NEAREST, "line: from the arm to the nearest obstacle; numbers: obstacles' ids"), (TARGET, "target"),
             (TRAIL, "path of the tool"), (GUIDE, "path that foresight has planned")]
    return STYLE + "".join(
        f"<div><span style='color:rgb{colour}'>&#9632;</span> {words}</div>" for colour, words in rows) + "</div>"


def words_of(status, ages_s, channel, waited_s):
    """The state of one controller as HTML. ages_s: kind of message -> s since the latest one.

    channel: of the status; waited_s: since the view listens.
    """
    stale = watch.stale_text(ages_s)
    if status is None:
        stale = f"waiting for {channel} for {waited_s:.0f} s: does the controller run, on this network?"
    rows = [("", stale)] if stale else [
        ("", *watch.mode_text(status), watch.speed_text(status)),
        ("clearance: ", watch.clearance_text(status, ages_s),
         watch.nearest_text(status) if watch.knows_clearance(status, ages_s) else ""),
        ("to the target: ", watch.target_text(status)),
        ("foresight: ", watch.foresight_text(status) or (DIRECT if status.mode == status.TRACK else "-"))]
    return STYLE + "".join(f"<div>{name}<b>{html.escape(str(what))}</b> {html.escape(' '.join(rest))}</div>"
                           for name, what, *rest in rows) + "</div>"


class Panel:
    def __init__(self, server, arms, layers):
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_layout="fixed", control_width="small")
        gui.set_panel_label("Sidestep")
        self.names = [one.name for one in arms]
        self.texts = [gui.add_html("") for _ in arms]
        self.channels, self.start_s = [one.names["CONTROLLER_STATUS"] for one in arms], time.monotonic()
        robot = "robot" if layers.visuals else "robot (no visual meshes found)"
        self.boxes = Layers(gui.add_checkbox(robot, layers.visuals, disabled=not layers.visuals),
                            gui.add_checkbox("controller's shapes", layers.shapes),
                            gui.add_checkbox("velocities", layers.arrows),
                            gui.add_checkbox("path of the tool", layers.trail))

    def layers(self):
        return Layers(*(box.value for box in self.boxes))

    def show(self, states):
        """states: (status or None, ages_s) of each arm."""
        for text, state, channel, name in zip(self.texts, states, self.channels, self.names):
            words = words_of(*state, channel, time.monotonic() - self.start_s)
            words = f"{STYLE}<b>{html.escape(name)}</b></div>{words}" if name else words
            if text.content != words:
                text.content = words


class Steering:
    """A target that a person drags; it is sent while the box is ticked."""

    def __init__(self, server):
        self.box = server.gui.add_checkbox("send a target: drag it", False)
        self.handle = server.scene.add_transform_controls("/steering", 0.25, disable_rotations=True, visible=False)

    def message(self, tool, to_base):
        """The target_t to send, or None. tool: 3, m, where the target starts; to_base: world to base frame."""
        if not self.box.value or tool is None:
            self.handle.visible = False
            return None
        if not self.handle.visible:
            self.handle.position, self.handle.visible = tool, True
        target = wire.target_t()
        target.utime, target.position = int(time.time() * 1e6), list(to_base(self.handle.position))
        return target
