"""A log drawn as the live view draws messages, and recorded by viser: a page with a time slider."""
import contextlib
import io

import viser

import logs
import watch
from stage import Stage, first_layers

FRAME_S = 0.03         # least time between two frames
MOST_FRAMES = 4000
CROWD = 100            # obstacles; more of them make the frames rarer
SLOW = 6               # colours change every SLOW frames
TRAIL_POINTS = 150
WORDS_M = (0.0, 0.0, -0.1)  # below an arm's base: where its state is written


def words_of(one, latest):
    status = latest.get(one.names["CONTROLLER_STATUS"])
    if status is None:
        return ""
    return f"{one.name} {': '.join(filter(None, watch.mode_text(status)))}".strip()


def page(log, arms, duration_s):
    """HTML that plays the log, viser's client included. arms: arm_view.ArmView each; duration_s: of the log."""
    with contextlib.redirect_stdout(io.StringIO()):  # viser prints the address of its server, which nobody needs
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        try:
            return recorded(server, log, arms, max(FRAME_S, duration_s / MOST_FRAMES)).as_html()
        finally:
            server.stop()


def recorded(server, log, arms, step_s):
    stage, layers = Stage(server, arms, TRAIL_POINTS), first_layers(arms)
    labels = [server.scene.add_label(f"/words{i}", "", position=one.point(WORDS_M), anchor="top-center")
              for i, one in enumerate(arms)]
    recording = server.get_scene_serializer()
    for number, (since_s, latest) in enumerate(frames(log, arms, step_s)):
        recording.insert_sleep(since_s)
        stage.draw(latest, layers, colours=number % SLOW == 0)
        for one, label in zip(arms, labels):
            label.text = words_of(one, latest)
    return recording


def frames(log, arms, step_s):
    """Yields (s since the frame before, messages) at cycles of the first arm that are step_s or more apart."""
    shown_s, obstacles = None, arms[0].names["OBSTACLES"]
    for t_s, latest in logs.cycles(log, arms, arms[0]):
        crowd = len(latest[obstacles].obstacles) / CROWD if obstacles in latest else 0
        if shown_s is None or t_s >= shown_s + step_s * max(crowd, 1) - 1e-6:
            yield t_s - (shown_s or 0.0), latest
            shown_s = t_s
