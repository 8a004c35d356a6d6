"""Texts in a picture at what they name, placed so that they cover neither each other nor a mark."""
import numpy as np

RINGS_PT = (16, 26, 38, 52, 70)  # how far a text may go from its point
DIRECTIONS = np.array([[x, y] for y in (1, -1, 0) for x in (0, 1, -1) if x or y])
NEAR_PT = 30    # a text nearer to its point needs no line to it
MARGIN_PT = 7     # between two texts, which else read as one


class Labels:
    """Collects texts and marks in the coordinates of a panel; place() writes the texts, the first ones first."""

    def __init__(self):
        self.marks, self.texts = [], []

    def keep_free(self, point, radius_pt):
        self.marks.append((point, radius_pt))

    def add(self, point, text, nearest_pt=0, **style):
        """nearest_pt: how far from its point the text begins to look for a place; 0: at the point itself."""
        self.texts.append((point, text, nearest_pt, style))

    def place(self, axes):
        """After the panel has its limits."""
        points_per_pixel = 72 / axes.figure.dpi
        taken = [box(axes.transData.transform(point) * points_per_pixel, np.full(2, 2 * radius_pt))
                 for point, radius_pt in self.marks]
        panel = np.array([axes.bbox.min, axes.bbox.max]) * points_per_pixel
        for point, text, nearest_pt, style in self.texts:
            written = axes.annotate(text, point, (0, 0), textcoords="offset points", ha="center", va="center",
                                    zorder=10, annotation_clip=True, **style)
            size = written.get_window_extent().size * points_per_pixel + MARGIN_PT
            place = axes.transData.transform(point) * points_per_pixel
            offset = min(candidates(nearest_pt), key=lambda one: cost(box(place + one, size), taken, panel))
            written.set_position(offset)
            if written.arrow_patch and np.linalg.norm(offset) < NEAR_PT:
                written.arrow_patch.set_visible(False)
            taken.append(box(place + offset, size))


def candidates(nearest_pt):
    rings = [ring * DIRECTIONS for ring in RINGS_PT if ring >= nearest_pt]
    return np.concatenate([np.zeros((0 if nearest_pt else 1, 2)), *rings])


def box(centre, size):
    """2 x 2: lower left and upper right corner."""
    return np.array([centre - size / 2, centre + size / 2])


def cost(one, taken, panel):
    """Area that is covered twice or lies outside of the panel; the first candidate with the least is taken."""
    covered = sum(common(one, other) for other in taken)
    return covered + np.prod(one[1] - one[0]) - common(one, panel)


def common(one, other):
    """The area that two boxes have in common."""
    return float(np.prod(np.maximum(np.minimum(one[1], other[1]) - np.maximum(one[0], other[0]), 0)))
