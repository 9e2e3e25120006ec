"""What the pictures of the gallery share: size, style, bodies in colours. Nothing to be run."""

import numpy as np
from carom_mesh import Mesh
from carom_plots import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, plt  # noqa: F401  (for pictures)
from carom_results import Result
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.tri import Triangulation

WIDTH, HEIGHT, DOTS = 8.0, 5.0, 100  # inches, dots an inch: 800 by 500, to be read at half of that
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 15, "axes.titlesize": 16, "axes.labelsize": 15,
    "xtick.labelsize": 13.5, "ytick.labelsize": 13.5, "legend.fontsize": 13.5,
    "figure.titlesize": 17, "lines.linewidth": 2.4, "axes.linewidth": 1.1, "axes.grid": True,
    "grid.alpha": 0.3, "axes.axisbelow": True, "axes.spines.top": False,
    "axes.spines.right": False, "figure.dpi": DOTS, "savefig.dpi": DOTS, "legend.frameon": True,
    "legend.framealpha": 0.9, "legend.borderpad": 0.3, "legend.labelspacing": 0.3,
    "legend.handlelength": 2.0, "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.06, "figure.constrained_layout.w_pad": 0.06,
}
EXACT = {"color": BLACK, "lw": 1.6, "ls": (0, (5, 2.5)), "zorder": 6}
WALL = {"facecolor": "0.87", "edgecolor": "0.6", "hatch": "//", "lw": 0, "zorder": 0}
# Lightness alone tells large from small; of stresses of both signs zero is white
STRESS, SPEED, SIGNED = "viridis", "cividis", "RdBu_r"


class Run(Result):
    """An open result file, with what pictures ask for most."""

    @property
    def pair(self):
        """The history of the first contact pair or set of gaps."""
        return self.contact(self.contacts[0])

    @property
    def hits(self):
        """When there were impacts."""
        return self.events.filter(kind="impact").time

    @property
    def mesh(self):
        return Mesh(self)


def figure(title, rows=1, columns=1, **options):
    """A figure of the gallery's size with its title, and its axes."""
    made, axes = plt.subplots(rows, columns, figsize=(WIDTH, HEIGHT), **options)
    made.suptitle(title, fontweight="bold")
    return made, axes


def mosaic(title, layout, **options):
    """A figure of the gallery's size with its title, and its axes by name."""
    made, axes = plt.subplot_mosaic(layout, figsize=(WIDTH, HEIGHT), **options)
    made.suptitle(title, fontweight="bold")
    return made, axes


def halves(title, ratio):
    """A figure of the gallery's size with its title, and its left and right part."""
    made = plt.figure(figsize=(WIDTH, HEIGHT))
    made.suptitle(title, fontweight="bold")
    return made, *made.subfigures(1, 2, width_ratios=(1, ratio))


def wall(axes, level, text, below=True):
    """A wall that fills the axes below (or above) an ordinate, with its name."""
    low, high = axes.get_ylim()
    edge = low if below else high
    axes.axhspan(edge, level, **WALL)
    axes.axhline(level, color="0.25", lw=1.6, zorder=1)
    axes.set_ylim(low, high)
    axes.text(0.012, 0.5 * (edge + level), text, va="center", zorder=7, fontsize=13.5,
              transform=axes.get_yaxis_transform(),
              bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})


def note(axes, x, y, text, colour=BLACK, **options):
    """A word beside a curve, in its colour, on a white ground."""
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85}
    options = {"fontsize": 13.5, "zorder": 8, "bbox": box, **options}
    axes.text(x, y, text, color=colour, **options)


def key_below(made, axes, columns=3):
    """The legend in a row below all axes."""
    handles, labels = axes.get_legend_handles_labels()
    made.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)


def body(axes, mesh, frame, field=None, limits=None, scale=1.0, colours=STRESS, lines=0.25):
    """The deformed mesh of a frame, in the colours of a field at its nodes; for a colour bar."""
    place = mesh.place(frame, scale)
    values = np.zeros(len(place)) if field is None else mesh.component("Point", field, frame)
    low, high = limits or (values.min(), values.max())
    many = sum(len(mesh.block(kind)[0]) for kind in mesh.solids()) > 1500
    painted = None
    for kind in mesh.solids():
        where, what, triangles = mesh.triangles(kind, place, values, 2 if many else 3)
        if field:
            painted = axes.tripcolor(Triangulation(*where.T, triangles), what, cmap=colours,
                                     shading="gouraud", vmin=low, vmax=high, zorder=2,
                                     rasterized=True)
        if lines or not field:
            axes.add_collection(PolyCollection(
                mesh.outlines(kind, place, 3), facecolors="none" if field else "#cfe3f2",
                edgecolors=(0, 0, 0, 0.45), lw=lines, zorder=3))
    edges = [e for block in mesh.boundary(place, 4) for e in block]
    axes.add_collection(LineCollection(edges, colors="black", lw=0.9, zorder=4))
    return painted


def lines_of(mesh):
    """The lower and upper corner of the points."""
    return mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)


def window(axes, low, high, title=None):
    """Equal scales, the range that is shown, no ticks: for bodies whose size the text gives."""
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)
    if title:
        axes.set_title(title, fontsize=14)


def ground(axes, level, low, high, depth):
    """A rigid plane below bodies."""
    axes.fill_between([low, high], level - depth, level, **WALL)
    axes.plot([low, high], [level, level], color="0.25", lw=1.6, zorder=1)


def bar(made, painted, axes, text, **options):
    """The colour bar of one field in several axes."""
    options = {"aspect": 22, "shrink": 0.9, **options}
    drawn = made.colorbar(painted, ax=axes, **options)
    drawn.set_label(text)
    drawn.ax.locator_params(nbins=5)
    return drawn


def nearest(times, wanted):
    """The frame or row whose time is nearest."""
    return int(np.argmin(np.abs(np.asarray(times) - wanted)))
