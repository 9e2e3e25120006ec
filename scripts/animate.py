"""A moving picture of a run: animate.py RESULT.h5 [--field MISES] [--scale 1] [--fps 25] [-o x.mp4]

Draws the frames of /VTKHDF in the x-y plane, points + scale * U, solids filled: with --field in
the colours of a field such as MISES, S22, V (its size) or V1. Rigid planes and circles appear if
the file has them, gap elements as thin lines, supports as grey squares, and where an impact has
just happened the node is red. Of a *FREQUENCY step one mode shape swings through a period, enlarged so
as to be seen: --mode 2. Writes a GIF, or with -o NAME.mp4 an MP4 film (needs ffmpeg).
"""

import os
import textwrap

import numpy as np
from carom_mesh import CORNERS, VERTEX, Mesh
from carom_plots import (
    BLACK, BLUE, ORANGE, RED, SKY, axis_label, colours_of, make_parser, output, plain, plt,
)
from carom_results import Result
from carom_script import ScriptError, finite, run
from matplotlib import animation
from matplotlib.collections import LineCollection, PolyCollection

MOST_FRAMES = 400
FLASH = 3  # pictures that an impact stays visible
SWING = 40  # pictures of the period of a mode


class Film:
    """The mesh, its frames and what else is to be seen."""

    def __init__(self, result, scale):
        self.mesh = mesh = Mesh(result)
        self.file, self.heading = result.file, result.heading
        self.scale = scale
        self.points, self.times, self.n_frames = mesh.points, mesh.times, mesh.n_frames
        self.events = result.events.filter(kind="impact")
        planes = self.file.get("model/rigid_planes")
        self.planes = np.zeros((0, 6)) if planes is None else np.atleast_2d(planes[()])
        circles = self.file.get("model/rigid_circles")
        self.circles = np.zeros((0, 4)) if circles is None else np.atleast_2d(circles[()])
        ids = self.file.get("model/node_id")
        self.point_of = {} if ids is None else {node: i for i, node in enumerate(ids[()].tolist())}
        self.gaps = mesh.lines(False)[1]
        self.line_cells, self.lines = mesh.lines(True)
        self.solids = mesh.solids()
        self.n_solids = sum(len(mesh.block(kind)[0]) for kind in self.solids)
        self.vertices = mesh.block(VERTEX)[1][:, 0]

    def place(self, frame):
        """The x and y of all points in a frame."""
        return self.mesh.place(frame, self.scale)

    def stress(self, frame):
        """The axial stress of the lines in a frame; None without any."""
        if "S" not in self.mesh.frames.names("Cell") or not len(self.lines):
            return None
        return self.mesh.component("Cell", "S11", frame)[self.line_cells]

    def field(self, name, frame):
        """The values of a field in the solids, a list with an array a type: the mean of each."""
        values = self.mesh.component("Cell", name, frame)
        if values is not None:
            return [values[self.mesh.block(kind)[0]] for kind in self.solids]
        values = self.mesh.component("Point", name, frame)
        if values is None:
            raise ScriptError(f"'{self.mesh.path}' has no field {name}; "
                              f"there are: {', '.join(self.mesh.fields())}")
        return [values[self.mesh.block(kind)[1][:, : CORNERS[kind]]].mean(axis=1)
                for kind in self.solids]

    def hits(self, frame, before):
        """Points with an impact since a frame before; of a gap element, both of its points."""
        if frame == 0 or len(self.events) == 0:
            return set()
        time = self.events.time
        recent = (time > self.times[before]) & (time <= self.times[frame])
        nodes = self.events.node[recent].tolist()
        hit = {self.point_of.get(node, -1) for node in nodes}
        for gap in self.gaps:
            if gap[1] in hit:  # the node of an event is the second of its gap
                hit.add(int(gap[0]))
        return hit

    def title(self, frame, hit):
        """What is seen, in words."""
        return f"time {self.times[frame]:.4g}" + (", impact" if hit else "")

    def still(self, frames):
        """Points that never move: supports."""
        looked_at = frames[:: max(1, len(frames) // 60)] + [frames[-1]]
        start = self.place(frames[0])
        ways = [np.abs(self.place(frame) - start).max(axis=1) for frame in looked_at]
        moved = np.max(ways, axis=0)
        return np.flatnonzero(moved == 0.0) if moved.max() > 0 else np.array([], int)

    def limits(self, frames):
        """The corners of all that is to be seen, with a margin."""
        looked_at = frames[:: max(1, len(frames) // 60)] + [frames[-1]]
        low = np.min([self.place(frame).min(axis=0) for frame in looked_at], axis=0)
        high = np.max([self.place(frame).max(axis=0) for frame in looked_at], axis=0)
        for point, normal in zip(self.planes[:, :3], self.planes[:, 3:]):
            axis = int(np.argmax(np.abs(normal[:2])))
            if np.abs(normal[axis]) > 0.99 * np.linalg.norm(normal):  # it is along x or y: show it
                low[axis] = min(low[axis], point[axis])
                high[axis] = max(high[axis], point[axis])
        size = max((high - low).max(), 1e-12)
        thin = high - low < 0.15 * size
        low, high = low - 0.06 * size, high + 0.06 * size
        low[thin] -= 0.08 * size
        high[thin] += 0.08 * size
        return low, high


class Swing(Film):
    """A mode shape through a period; its frames are the pictures of that."""

    def __init__(self, result, number, scale):
        super().__init__(result, scale)
        modes = sorted(self.mesh.modes())
        if not 1 <= number <= len(modes):
            raise ScriptError(f"'{self.mesh.path}' has the modes 1 to {len(modes)}, not {number}"
                              if modes else f"'{self.mesh.path}' has no modes (*FREQUENCY with "
                              "*NODE FILE writes them)")
        self.mode = modes[number - 1]
        self.scale = self.mesh.visible_scale(self.mode) if scale is None else scale
        self.n_frames = SWING

    def part(self, frame):
        """The part of the full swing, -1 to 1."""
        return np.sin(2 * np.pi * frame / SWING)

    def place(self, frame):
        return self.mesh.place(self.mode, self.scale * self.part(frame))

    def stress(self, frame):
        whole = super().stress(self.mode)
        return whole if whole is None else self.part(frame) * whole

    def field(self, name, frame):
        """A component follows the swing; a size, as MISES, is never negative."""
        part = self.part(frame) if name[-1].isdigit() else abs(self.part(frame))
        return [part * values for values in super().field(name, self.mode)]

    def hits(self, frame, before):
        return set()

    def title(self, frame, hit):
        return self.mesh.mode_title(self.mode)


def draw_planes(axes, film, low, high):
    """Each rigid plane as an edge, with a strip on its solid side."""
    reach = np.linalg.norm(high - low)
    for point, normal in zip(film.planes[:, :2], film.planes[:, 3:5]):
        length = np.linalg.norm(normal)
        if length < 1e-9:
            continue  # faces along z
        normal = normal / length
        along = np.array([-normal[1], normal[0]])
        foot = point + along * np.dot(0.5 * (low + high) - point, along)
        ends = np.array([foot - 2 * reach * along, foot + 2 * reach * along])
        solid = np.vstack((ends, ends[::-1] - 0.03 * reach * normal))
        axes.fill(*solid.T, color="0.8", zorder=0)
        axes.plot(*ends.T, color="0.4", lw=1.5, zorder=1)


def draw_circles(axes, film, low, high):
    """Each rigid circle as an edge, grey where it is solid; a negative radius: outside of it."""
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    for x, y, _, radius in film.circles:
        angle = np.linspace(0, 2 * np.pi, 361)
        rim = np.stack((x + radius * np.cos(angle), y + radius * np.sin(angle)), axis=1)
        if radius > 0:
            axes.fill(*rim.T, color="0.8", zorder=0)
        else:
            box = 2 * corners - corners.mean(axis=0)
            both = np.vstack((box, box[:1], rim[::-1], box[:1]))
            axes.fill(*both.T, color="0.8", zorder=0)
        axes.plot(*rim.T, color="0.4", lw=1.5, zorder=1)


class Picture:
    """The drawn frame, updated in place."""

    def __init__(self, film, frames, field=None):
        self.film = film
        self.field = field
        low, high = film.limits(frames)
        width, height = high - low
        aspect = height / width
        wide = 7.6 if aspect < 1 else max(5.0, 7.6 / aspect + 0.6)
        self.heading = [plain(line) for line in textwrap.wrap(film.heading, int(9.5 * wide))[:2]]
        above = 0.45 + 0.2 * len(self.heading)
        tall = min(max(wide * aspect, 1.6), 7.6) + 0.72 + above
        self.figure, self.axes = plt.subplots(figsize=(wide, tall), dpi=90)
        self.figure.subplots_adjust(left=0.12, right=0.97, top=1.0 - above / tall,
                                    bottom=0.68 / tall)
        self.axes.set_xlim(low[0], high[0])
        self.axes.set_ylim(low[1], high[1])
        self.axes.set_aspect("equal")
        self.axes.set_xlabel("x")
        self.axes.set_ylabel("y")
        self.axes.grid(False)
        draw_planes(self.axes, film, low, high)
        draw_circles(self.axes, film, low, high)
        few = len(film.points) <= 60
        width = 0.6 if film.n_solids <= 200 else 0.25 if film.n_solids <= 5000 else 0.0
        rest = SKY if field is None else "face"
        face = {"facecolor": SKY} if field is None else {}
        self.faces = [PolyCollection([], edgecolor=BLACK if width else rest, lw=width or 0.3, **face)
                      for _ in film.solids]
        if field is not None:
            self.show_field(frames)
        self.stressed = field is None and film.stress(frames[0]) is not None
        colour = {} if self.stressed else {"color": BLUE}
        self.lines = LineCollection([], lw=3.0 if few else 2.0, **colour)
        self.gaps = LineCollection([], color="0.6", lw=1.0, linestyles="dotted", zorder=1)
        still = film.still(frames)
        if few and len(still) and not film.solids:
            self.axes.scatter(*film.points[still, :2].T, s=160, marker="s", color="0.6", zorder=2)
        self.axes.add_collection(self.gaps)
        for faces in self.faces:
            self.axes.add_collection(faces)
        self.axes.add_collection(self.lines)
        self.show_stress(frames)
        only_chain = not film.solids
        shown = np.arange(len(film.points)) if only_chain and few else np.array(film.vertices, int)
        self.shown = np.setdiff1d(shown, still)
        size = 90 if len(shown) <= 5 else 30 if len(shown) <= 20 else 8
        self.dots = self.axes.scatter([], [], s=size, color=BLUE, edgecolor=BLACK, zorder=3)
        self.flash = self.axes.scatter([], [], s=260, color=ORANGE, alpha=0.6, lw=0, zorder=2.5)
        self.title = self.axes.set_title("", fontsize=12)

    def show_field(self, frames):
        """Solids in the colours of a field, the same in all frames."""
        film = self.film
        if not film.n_solids:
            raise ScriptError("--field needs solids")
        looked_at = frames[:: max(1, len(frames) // 60)] + [frames[-1]]
        shown = np.concatenate([np.concatenate(film.field(self.field, f)) for f in looked_at])
        # a few points of concentrated stress would leave all else in one colour
        style = colours_of(shown, f"'{film.mesh.path}': {self.field}", inner=0.996)
        for faces in self.faces:
            faces.set(**style)
        self.figure.subplots_adjust(right=0.84)
        box = self.axes.get_position()
        place = self.figure.add_axes((0.86, box.y0, 0.02, box.height))
        bar = self.figure.colorbar(self.faces[0], cax=place, extend="both")
        bar.formatter.set_powerlimits((-2, 3))
        bar.set_label(axis_label(self.field))

    def show_stress(self, frames):
        """Lines in the colour of their stress, if the file has it."""
        if not self.stressed:
            return
        looked_at = frames[:: max(1, len(frames) // 60)] + [frames[-1]]
        most = max(np.abs(self.film.stress(frame)).max() for frame in looked_at)
        self.lines.set(cmap="coolwarm", clim=(-most, most), linewidth=6.0)
        self.figure.subplots_adjust(right=0.85)
        box = self.axes.get_position()
        place = self.figure.add_axes((0.87, box.y0, 0.02, box.height))
        bar = self.figure.colorbar(self.lines, cax=place, ticks=[-most, 0.0, most])
        bar.ax.set_title("stress", fontsize=11)
        bar.ax.set_yticklabels([f"{-most:.3g}", "0", f"{most:.3g}"])

    def show(self, frame, before):
        """Draws one frame."""
        place = self.film.place(frame)
        for kind, faces in zip(self.film.solids, self.faces):
            faces.set_verts(self.film.mesh.outlines(kind, place, 4))
        if self.field is not None:
            for faces, values in zip(self.faces, self.film.field(self.field, frame)):
                faces.set_array(values)
        self.lines.set_segments(place[self.film.lines])
        if self.stressed:
            self.lines.set_array(self.film.stress(frame))
        self.gaps.set_segments(place[self.film.gaps])
        self.dots.set_offsets(place[self.shown] if len(self.shown) else np.empty((0, 2)))
        hit = self.film.hits(frame, before)
        self.dots.set_facecolor([RED if point in hit else BLUE for point in self.shown])
        struck = place[sorted(hit - {-1})] if hit - {-1} else np.empty((0, 2))
        self.flash.set_offsets(struck)
        for spine in self.axes.spines.values():
            spine.set_edgecolor(RED if hit else BLACK)
            spine.set_linewidth(3.0 if hit else 0.8)
        self.title.set_text("\n".join([*self.heading, self.film.title(frame, hit)]))
        self.title.set_color(RED if hit else BLACK)


def writer_for(path, fps):
    """The writer that the ending of the file asks for."""
    if path.lower().endswith(".gif"):
        return animation.PillowWriter(fps=fps)
    if path.lower().endswith(".mp4"):
        if not animation.FFMpegWriter.isAvailable():
            raise ScriptError("an MP4 film needs ffmpeg, which is not installed; a .gif does not")
        return animation.FFMpegWriter(fps=fps)
    raise ScriptError(f"'{path}' should end in .gif or .mp4")


def write(picture, steps, path, fps):
    """The film as a file."""
    writer = writer_for(path, fps)
    try:
        with writer.saving(picture.figure, path, dpi=90):
            for step in steps:
                picture.show(*step)
                writer.grab_frame()
    except OSError as error:
        raise ScriptError(f"cannot write '{path}': {error}") from None
    print(f"{path}: {len(steps)} frames, {os.path.getsize(path) / 1e6:.1f} MB")


def choose_film(result, given):
    """The frames in time, or a mode where there are modes."""
    if given.mode is None and "frequency" not in result.file:
        return Film(result, 1.0 if given.scale is None else given.scale)
    if given.every is not None:
        raise ScriptError("--every takes frames in time, and a mode has none")
    return Swing(result, 1 if given.mode is None else given.mode, given.scale)


def main():
    parser = make_parser(__doc__, "film: .gif or .mp4")
    parser.add_argument("--field", help="colours of the solids: MISES, S11, V, V1, U, ...")
    parser.add_argument("--scale", type=finite,
                        help="factor on the displacements (1; of a mode chosen to be seen)")
    parser.add_argument("--mode", type=int, help="the mode that swings, of a *FREQUENCY step (1)")
    parser.add_argument("--every", type=int, help=f"every n-th frame (so that <= {MOST_FRAMES})")
    parser.add_argument("--fps", type=finite, default=25.0, help="pictures a second (25)")
    given = parser.parse_args()
    if given.fps <= 0 or (given.every is not None and given.every < 1):
        raise ScriptError("--fps and --every must be positive")
    with Result(given.result) as result:
        film = choose_film(result, given)
        every = given.every or -(-film.n_frames // MOST_FRAMES)
        frames = list(range(0, film.n_frames, every))
        picture = Picture(film, frames, given.field and given.field.upper())
        steps = list(zip(frames, [0] * FLASH + frames))
        if given.output or not given.show:
            write(picture, steps, output(given, result, ".gif"), given.fps)
        if given.show:
            moving = animation.FuncAnimation(
                picture.figure, lambda step: picture.show(*step), steps, init_func=lambda: None,
                interval=1000.0 / given.fps, cache_frame_data=False)
            plt.show()
            moving.pause()


if __name__ == "__main__":
    run(main)
