"""The profile (skyline) of the effective stiffness matrix: plot_profile.py RESULT.h5

Each column is drawn from its first stored row down to the diagonal, in one colour where an
implicit element touches the equation and in another where only explicit elements do: those
columns hold the diagonal alone. Prints the number of equations and the size of the profile.
"""

import numpy as np
from carom_plots import BLUE, ORANGE, deliver, head, make_parser, plt
from carom_results import Result
from carom_script import ScriptError, run
from carom_tables import BINS, minmax
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

MOST_CELLS = 1200  # equations up to which every entry is drawn as a cell


def read(result):
    """Column heights, and which equations are implicit."""
    heights = np.atleast_1d(result.array("model/profile")).astype(int)
    implicit = np.atleast_1d(result.array("model/implicit")) != 0
    if len(heights) != len(implicit) or len(heights) == 0:
        raise ScriptError(f"'{result.path}': /model/profile and implicit differ in length")
    if heights.min() < 1 or (heights > np.arange(1, len(heights) + 1)).any():
        raise ScriptError(f"'{result.path}': /model/profile has a height that no column can have")
    return heights, implicit


def draw_cells(axes, heights, implicit):
    """Every stored entry as a cell."""
    n = len(heights)
    row, column = np.indices((n, n))
    stored = (row <= column) & (row > column - heights[None, :])
    kind = np.where(stored, np.where(implicit[None, :], 1, 2), 0)
    axes.imshow(
        kind, cmap=ListedColormap(["white", BLUE, ORANGE]), vmin=0, vmax=2, interpolation="nearest",
        extent=(0.5, n + 0.5, n + 0.5, 0.5),
    )
    if n <= 60:
        axes.set_xticks(np.arange(0.5, n + 1), minor=True)
        axes.set_yticks(np.arange(0.5, n + 1), minor=True)
        axes.grid(which="minor", color="white", linewidth=0.8, alpha=1.0)
        axes.tick_params(which="minor", length=0)


def draw_outline(axes, heights, implicit):
    """The area between skyline and diagonal; of columns in one pixel the highest."""
    n = len(heights)
    bins = min(n, BINS)
    for chosen, colour in ((implicit, BLUE), (~implicit, ORANGE)):
        top = minmax(np.where(chosen, heights, np.nan), bins)[1]
        column = (np.arange(bins) + 0.5) * n / bins + 0.5
        axes.fill_between(
            column, column - top + 0.5, column + 0.5, where=~np.isnan(top), step="mid",
            color=colour, linewidth=1.5,
        )
    axes.set_xlim(0.5, n + 0.5)
    axes.set_ylim(n + 0.5, 0.5)
    axes.set_aspect("equal")


def draw(result, heights, implicit):
    """The figure."""
    n = len(heights)
    figure, axes = plt.subplots(figsize=(7.5, 8.2), layout="constrained")
    (draw_cells if n <= MOST_CELLS else draw_outline)(axes, heights, implicit)
    axes.grid(False, which="major")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(nbins=8, integer=True, min_n_ticks=1))
    axes.set_xlabel("column (equation)")
    axes.set_ylabel("row (equation)")
    head(figure, result, f"{n} equations, {heights.sum()} entries, mean height {heights.mean():.1f}")
    handles = [
        Patch(color=BLUE, label=f"implicit ({implicit.sum()} columns)"),
        Patch(color=ORANGE, label=f"explicit only ({(~implicit).sum()} columns)"),
    ]
    axes.legend(handles=handles, loc="lower left")
    return figure


def main():
    parser = make_parser(__doc__)
    given = parser.parse_args()
    with Result(given.result) as result:
        heights, implicit = read(result)
        print(f"equations           {len(heights)}")
        print(f"profile size        {heights.sum()}")
        print(f"mean column height  {heights.mean():.2f}")
        deliver(draw(result, heights, implicit), given, result, "_profile.png")


if __name__ == "__main__":
    run(main)
