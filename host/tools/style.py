"""Colours and common parts of the figures."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# The palette of Okabe and Ito, which stays distinguishable with every kind of colour vision.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PINK = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2",
                                                      "#D55E00", "#CC79A7")
# A colour has one meaning: orange and blue are the laws, pink is what moves, yellow what is
# held, grey what rests, green the target.
LAW_COLOURS = {"paper": ORANGE, "sidestep": BLUE}
LAW_LINES = {"paper": dict(color=ORANGE, linewidth=3), "sidestep": dict(color=BLUE, linewidth=1.9)}
MOVING, HELD, RESTING, OTHER_ARM, TARGET, CONTACT = PINK, YELLOW, "0.72", "#7A6A00", GREEN, "#C00000"
JOINTS = ["#332288", "#117733", "#DDAA33", "#88CCEE", "#882255", "#999933", BLACK]
GREY = "0.55"

plt.rcParams.update({"font.size": 9.5, "axes.titlesize": 11, "axes.titlelocation": "left", "axes.grid": True,
                     "grid.color": "0.9", "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "legend.fontsize": 9, "savefig.dpi": 150, "lines.linewidth": 1.6})


def legend_rows(labels, columns):
    """Lines of text in the longest column of a legend, which matplotlib fills column by column."""
    if not labels or not columns:
        return 0
    heights, shares = [label.count("\n") + 1 for label in labels], divmod(len(labels), columns)
    ends = np.cumsum([shares[0] + (column < shares[1]) for column in range(columns)])
    return max(sum(heights[start:end]) for start, end in zip([0, *ends], ends))


def finish(axes, title, legend_columns=3, **settings):
    """Title and legend above the panel, where they cover no curve. legend_columns: 0 for no legend."""
    axes.set(**settings)
    labels = axes.get_legend_handles_labels()[1]
    rows = legend_rows(labels, legend_columns)
    if rows:
        axes.legend(ncol=legend_columns, loc="lower left", bbox_to_anchor=(-0.01, 1.0), borderaxespad=0.1,
                    columnspacing=1.2, handlelength=1.6, labelspacing=0.3)
    axes.set_title(title, fontweight="bold", pad=6 + 13.2 * rows)


def save(figure, file, metadata=None):
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, metadata=metadata)
    plt.close(figure)
    return file
