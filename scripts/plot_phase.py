"""Phase portrait of a node: plot_phase.py RESULT.h5 [--node 2] [--dof 1] [--wall -0.5]

Velocity over displacement. The jumps at impacts come from /events, which has the velocities
before and after an impact; the history has only those at the end of each increment. Of very long
histories the picture shows how many rows lie in each pixel.
"""

import numpy as np
from carom_plots import (
    BLACK, BLUE, RED, deliver, head, label, legend_below, make_parser, plt,
)
from carom_results import Result
from carom_script import ScriptError, finite, run
from carom_tables import Computed, minmax
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm

WORST_MISMATCH = 1.5  # between an event's and the history's velocity, in changes of one increment
MOST_ROWS = 200000  # beyond which the number of rows in each pixel is drawn, not the path
MOST_JUMPS = 400  # impacts beyond which they are not drawn
PIXELS = 360
DOFS = (1, 2, 3)


def choose(result, node, dof):
    """Node and freedom: as asked, or the first freedom that has both U and V at some node; of nodes
    with them that of the first impact, else the first."""
    nodes = result.nodes if node is None else [node]
    there = {}
    for number in nodes:
        history = result.node(number)
        for n in DOFS:
            if f"U{n}" in history and f"V{n}" in history:
                there.setdefault(n, []).append(number)
    if dof not in (there if dof else [None]) or not there:
        which = "node" if node is None else f"node {node}"
        wanted = f"both U{dof} and V{dof}" if dof else "both U and V in one direction"
        known = " or ".join(f"--dof {n}" for n in there)
        raise ScriptError(f"'{result.path}' has no {which} with {wanted} in /history "
                          f"(*NODE PRINT with U, V)" + (f"; there is {known}" if known else ""))
    dof = dof or min(there)
    known = set(there[dof])
    hit = (event.node for event in result.events if event.node in known)
    return next(hit, there[dof][0]), dof


def jumps(events, time, d, v):
    """Index of the history row after each impact, displacement and velocities before and after."""
    found = []
    for when, before, after in zip(events.time, events.gap_rate_before, events.gap_rate_after):
        row = int(np.searchsorted(time, when))
        if row == 0 or row >= len(time):
            continue
        # gap rate and velocity agree up to the sign of the wall's normal
        sign = 1.0 if abs(v[row - 1] - before) <= abs(v[row - 1] + before) else -1.0
        v_before, v_after = sign * before, sign * after
        if found and found[-1][0] == row:  # a second impact within one increment
            place = found[-1][1]
        elif not fits(v, row, v_before, v_after):
            continue
        else:
            place = d[row - 1] + 0.5 * (when - time[row - 1]) * (v[row - 1] + v_before)
        found.append((row, place, v_before, v_after))
    # against a node that moves, gap rates are no velocities, though a few may seem so
    return found if len(found) > 0.8 * len(events) else []


def fits(v, row, before, after):
    """Whether the rates of an event are velocities of the node; where it meets a node that moves
    they are not, and the history's own points are drawn."""
    near = np.abs(np.diff(v[max(row - 3, 0) : row])), np.abs(np.diff(v[row : row + 3]))
    usual = max([change.max() for change in near if len(change)], default=np.inf)
    limit = WORST_MISMATCH * usual + 1e-9 * np.abs(v).max()
    return abs(v[row - 1] - before) <= limit and abs(v[row] - after) <= limit + abs(before) * 0.5


def draw_path(axes, result, node, dof):
    """Free flights in one colour, jumps in another."""
    history = result.node(node)
    table = history.arrays(["time", f"U{dof}", f"V{dof}"])
    time, d, v = table.values()
    if not len(time):
        raise ScriptError(f"'{result.path}': /history has no rows yet")
    events = result.events.filter(kind="impact", node=node)
    found = jumps(events, time, d, v) if len(events) <= MOST_JUMPS else []
    begin, lead = 0, ([], [])
    for row, place, before, after in found:
        flight = slice(begin, row)
        axes.plot([*lead[0], *d[flight], place], [*lead[1], *v[flight], before], color=BLUE, lw=1.2)
        axes.plot([place, place], [before, after], color=RED, lw=1.0, ls="--", zorder=3)
        axes.plot([place], [before], "o", color=RED, ms=5, zorder=4)
        axes.plot([place], [after], "o", mfc="white", mec=RED, ms=5, zorder=4)
        begin, lead = row, ([place], [after])
    axes.plot([*lead[0], *d[begin:]], [*lead[1], *v[begin:]], color=BLUE, lw=1.2)
    axes.plot(d[0], v[0], "s", color=BLACK, ms=8, zorder=5, label="start")
    if found:
        axes.plot([], [], "o--", color=RED, ms=5, label=f"{len(found)} impacts, before")
        axes.plot([], [], "o", mfc="white", mec=RED, ms=5, label="after")


def pixel(values, low, high):
    """The number of the pixel in which each value lies."""
    return np.clip((values - low) / (high - low) * PIXELS, 0, PIXELS - 1).astype(int)


def draw_density(figure, axes, columns):
    """How many rows lie in each pixel: of histories whose path would fill the picture."""
    ranges = []
    for column in columns:
        low, high = (float(part[0]) for part in minmax(column, 1))
        margin = 0.05 * (high - low) or 1.0
        ranges.append((low - margin, high + margin))
    counts = np.zeros(PIXELS * PIXELS, int)
    for pixels in Computed(lambda d, v: pixel(v, *ranges[1]) * PIXELS + pixel(d, *ranges[0]),
                           *columns).blocks():
        counts += np.bincount(pixels, minlength=PIXELS * PIXELS)
    counts = counts.reshape(PIXELS, PIXELS)
    scale = ScalarMappable(LogNorm(1, max(counts.max(), 2)), "viridis_r")
    image = scale.to_rgba(counts, bytes=True)
    image[counts == 0] = 255
    axes.imshow(image, origin="lower", aspect="auto", extent=(*ranges[0], *ranges[1]),
                interpolation="nearest")
    figure.colorbar(scale, ax=axes, label="rows in a pixel")


def draw(result, node, dof, wall):
    """The figure."""
    history = result.node(node)
    columns = history[f"U{dof}"], history[f"V{dof}"]
    figure, axes = plt.subplots(figsize=(7.5, 7.4), layout="constrained")
    if len(history) <= MOST_ROWS:
        draw_path(axes, result, node, dof)
    else:
        draw_density(figure, axes, columns)
    if wall is not None:
        axes.axvline(wall, color="0.8", lw=9, zorder=0, label="wall")
    axes.set_xlabel(f"displacement {label(f'node_{node}/U{dof}')}")
    axes.set_ylabel(f"velocity {label(f'node_{node}/V{dof}')}")
    axes.margins(0.06)
    if axes.get_legend_handles_labels()[1]:
        legend_below(figure, 4)
    head(figure, result)
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("--node", type=int, help="its id (default: the first that hits something)")
    parser.add_argument("--dof", type=int, choices=DOFS, help="default: the first there is")
    parser.add_argument("--wall", type=finite, help="displacement at which the wall stands")
    given = parser.parse_args()
    with Result(given.result) as result:
        node, dof = choose(result, given.node, given.dof)
        deliver(draw(result, node, dof, given.wall), given, result, "_phase.png")


if __name__ == "__main__":
    run(main)
