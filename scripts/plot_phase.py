"""Phase portrait of a node: plot_phase.py RESULT.h5 [--node 2] [--dof 1] [--wall -0.5]

Velocity over displacement. The jumps at impacts come from /events, which has the velocities
before and after an impact; the history has only those at the end of each increment.
"""

import numpy as np
from carom_results import (
    BLUE, RED, Results, ScriptError, label, make_parser, plt, run, save,
)

WORST_MISMATCH = 1.5  # between an event's and the history's velocity, in changes of one increment


def choose_node(results, dof):
    """The node of the first impact that has a history, else the first node that has one."""
    known = set(results.columns("history"))
    nodes = [name.split("/")[0] for name in results.columns("history") if name.endswith(f"/U{dof}")]
    nodes = [node for node in nodes if f"{node}/V{dof}" in known]
    if not nodes:
        raise ScriptError(
            f"'{results.path}' has no node with both U{dof} and V{dof} in /history "
            "(*NODE PRINT with U, V)"
        )
    hit = [f"node_{number}" for number in results.events().get("node", [])]
    return next((node for node in hit if node in nodes), nodes[0])


def jumps(events, node, time, d, v):
    """Index of the history row after each impact, displacement and velocities before and after."""
    found = []
    if "node" not in events or "gap_rate_after" not in events:
        return found
    mine = (events["node"] == node) & (events["kind"] == "impact")
    for when, before, after in zip(
        events["time"][mine], events["gap_rate_before"][mine], events["gap_rate_after"][mine]
    ):
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
    return found if len(found) > 0.8 * mine.sum() else []


def fits(v, row, before, after):
    """Whether the rates of an event are velocities of the node; where it meets a node that moves
    they are not, and the history's own points are drawn."""
    near = np.abs(np.diff(v[max(row - 3, 0) : row])), np.abs(np.diff(v[row : row + 3]))
    usual = max([change.max() for change in near if len(change)], default=np.inf)
    limit = WORST_MISMATCH * usual + 1e-9 * np.abs(v).max()
    return abs(v[row - 1] - before) <= limit and abs(v[row] - after) <= limit + abs(before) * 0.5


def draw(results, node, dof, wall):
    """The figure: free flights in one colour, jumps in another."""
    names = [f"{node}/U{dof}", f"{node}/V{dof}"]
    table = results.table("history", ["time", *names])
    time, d, v = (table[name] for name in ("time", *names))
    number = int(node.split("_")[1])
    found = jumps(results.events(), number, time, d, v)
    figure, axes = plt.subplots(figsize=(7.5, 7), layout="constrained")
    begin, lead = 0, ([], [])
    for row, place, before, after in found:
        flight = slice(begin, row)
        axes.plot([*lead[0], *d[flight], place], [*lead[1], *v[flight], before], color=BLUE, lw=1.2)
        axes.plot([place, place], [before, after], color=RED, lw=1.0, ls="--", zorder=3)
        axes.plot([place], [before], "o", color=RED, ms=5, zorder=4)
        axes.plot([place], [after], "o", mfc="white", mec=RED, ms=5, zorder=4)
        begin, lead = row, ([place], [after])
    axes.plot([*lead[0], *d[begin:]], [*lead[1], *v[begin:]], color=BLUE, lw=1.2)
    axes.plot(d[0], v[0], "s", color=BLUE, ms=6, label="start")
    if found:
        axes.plot([], [], "o--", color=RED, ms=5, label=f"{len(found)} impacts, before")
        axes.plot([], [], "o", mfc="white", mec=RED, ms=5, label="after")
    if wall is not None:
        axes.axvline(wall, color="0.8", lw=9, zorder=0, label="wall")
    axes.set_xlabel(f"displacement {label(names[0])}")
    axes.set_ylabel(f"velocity {label(names[1])}")
    axes.legend(loc="best")
    return figure


def main():
    parser = make_parser(__doc__)
    parser.add_argument("result", help="result file of carom")
    parser.add_argument("--node", type=int, help="its id (default: the first that hits something)")
    parser.add_argument("--dof", type=int, default=1, choices=(1, 2, 3), help="default 1")
    parser.add_argument("--wall", type=float, help="displacement at which the wall stands")
    arguments = parser.parse_args()
    with Results(arguments.result) as results:
        node = f"node_{arguments.node}" if arguments.node else choose_node(results, arguments.dof)
        figure = draw(results, node, arguments.dof, arguments.wall)
        save(figure, results.output(arguments.output, "_phase.png"))


if __name__ == "__main__":
    run(main)
