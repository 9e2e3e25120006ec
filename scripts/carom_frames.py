"""The frames of a result file: the mesh with its fields at the times that FILE cards asked for.

    frame = result.frames[-1]            or result.frames.at(0.5), the nearest in time
    frame.time, frame.points             points undeformed, (n, 3)
    frame.U, frame.S                     (n, 3) and (n, 6): 11 22 33 12 23 13
    frame.point_data["S"]                at the points, frame.cell_data["S"] in the cells
    frame.cells                          {VTK type: (numbers of the cells, their points)}
    frame.to_meshio().write("x.vtu")     needs meshio
    frame.to_pyvista().warp_by_vector("U").plot()    needs pyvista

frame.NAME is the field at the points if the file has it there, else in the cells. Fields are read
when they are named. After *FREQUENCY a frame is a mode, and its time is the frequency.

In the file a field that is as it was in the frame before is not written again; where the values of
a frame begin is in /VTKHDF/Steps/PointDataOffsets and CellDataOffsets.
"""

import collections.abc
import functools

import numpy as np
from carom_script import MissingError, ScriptError, need

MESHIO_NAMES = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 21: "line3", 22: "triangle6",
                23: "quad8"}


def all_frames(grid, where, name):
    """A field at the points ("Point") or in the cells ("Cell") of /VTKHDF, in all its frames
    (frame, point or cell, component)."""
    begins = grid[f"Steps/{where}DataOffsets/{name}"][: int(grid["Steps"].attrs["NSteps"])]
    count = len(grid["Points" if where == "Point" else "Types"])
    return grid[f"{where}Data/{name}"][()][begins[:, None] + np.arange(count)]


class Frames(collections.abc.Sequence):
    """All frames of a file, and the mesh that they share."""

    def __init__(self, result):
        self.path = result.path
        self.file = result.file
        self.grid = self.file.get("VTKHDF")
        if self.grid is None or "Steps" not in self.grid:
            raise ScriptError(f"'{self.path}' has no frames in /VTKHDF "
                              "(*NODE FILE, *EL FILE and *CONTACT FILE write them)")
        self.times = self.grid["Steps/Values"][: int(self.grid["Steps"].attrs["NSteps"])]

    def __len__(self):
        return len(self.times)

    def __getitem__(self, number):
        if isinstance(number, slice):
            return [Frame(self, k) for k in range(*number.indices(len(self)))]
        if not -len(self) <= number < len(self):
            raise IndexError(f"'{self.path}' has {len(self)} frames, none with the number {number}")
        return Frame(self, number % len(self))

    def at(self, time):
        """The frame nearest to a time."""
        if not len(self):
            raise ScriptError(f"'{self.path}' has no frames yet")
        return self[int(np.argmin(np.abs(self.times - time)))]

    @functools.cached_property
    def points(self):
        """The undeformed places of the points (n, 3)."""
        return self.grid["Points"][()]

    @functools.cached_property
    def types(self):
        """The VTK type of each cell."""
        return self.grid["Types"][()]

    @functools.cached_property
    def cells(self):
        """The cells by VTK type: their numbers and their points."""
        offsets, connectivity = self.grid["Offsets"][()], self.grid["Connectivity"][()]
        found = {}
        for kind in np.unique(self.types):
            cells = np.flatnonzero(self.types == kind)
            n = int(offsets[cells[0] + 1] - offsets[cells[0]])
            found[int(kind)] = cells, connectivity[offsets[cells][:, None] + np.arange(n)]
        return found

    def names(self, where):
        """The fields at the points ("Point") or in the cells ("Cell")."""
        return list(self.grid.get(f"{where}Data", ()))

    def values(self, where, name, number):
        """A field in one frame."""
        if name not in self.names(where):
            place = {"Point": "at its points", "Cell": "in its cells"}[where]
            raise MissingError(f"'{self.path}' has no field {name} {place}; "
                               f"there are: {', '.join(self.names(where)) or 'none'}")
        begin = int(self.grid[f"Steps/{where}DataOffsets/{name}"][number])
        count = len(self.points) if where == "Point" else len(self.types)
        return self.grid[f"{where}Data/{name}"][begin : begin + count]


class Fields(collections.abc.Mapping):
    """The fields of a frame at the points or in the cells, read when they are asked for."""

    def __init__(self, frames, where, number):
        self._frames, self._where, self._number = frames, where, number

    def __getitem__(self, name):
        return self._frames.values(self._where, name, self._number)

    def __iter__(self):
        return iter(self._frames.names(self._where))

    def __len__(self):
        return len(self._frames.names(self._where))


class Frame:
    """The mesh with its fields at one time."""

    def __init__(self, frames, number):
        self._frames, self.number = frames, number
        self.time = float(frames.times[number])
        self.point_data = Fields(frames, "Point", number)
        self.cell_data = Fields(frames, "Cell", number)

    @property
    def points(self):
        """The undeformed places of the points (n, 3)."""
        return self._frames.points

    @property
    def cells(self):
        """The cells by VTK type: their numbers and their points."""
        return self._frames.cells

    @property
    def names(self):
        """The names of all fields."""
        return list(dict.fromkeys([*self.point_data, *self.cell_data]))

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        for fields in (self.point_data, self.cell_data):
            if name in fields:
                return fields[name]
        raise MissingError(f"'{self._frames.path}' has no field {name} (*NODE FILE, *EL FILE and "
                           f"*CONTACT FILE write them); there are: {', '.join(self.names)}")

    def __repr__(self):
        return f"<frame {self.number}, time {self.time:g}: {', '.join(self.names)}>"

    def to_meshio(self):
        """A meshio.Mesh with all fields."""
        meshio = need("meshio", "to_meshio")
        blocks = [(MESHIO_NAMES[kind], points) for kind, (_, points) in self.cells.items()]
        data = {name: [values[cells] for cells, _ in self.cells.values()]
                for name, values in self.cell_data.items()}
        return meshio.Mesh(self.points, blocks, point_data=dict(self.point_data), cell_data=data)

    def to_pyvista(self):
        """A pyvista.UnstructuredGrid with all fields."""
        pyvista = need("pyvista", "to_pyvista")
        grid = self._frames.grid
        connectivity, offsets = grid["Connectivity"][()], grid["Offsets"][()]
        cells = np.insert(connectivity, offsets[:-1], np.diff(offsets))
        mesh = pyvista.UnstructuredGrid(cells, self._frames.types, self.points)
        for fields, data in ((self.point_data, mesh.point_data), (self.cell_data, mesh.cell_data)):
            for name, values in fields.items():
                data[name] = values
        mesh.field_data["TimeValue"] = [self.time]
        return mesh
