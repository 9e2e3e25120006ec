"""Checks that VTK reads every frame of a result file: read_with_vtk.py RESULT.h5

Steps through all times of /VTKHDF with vtkHDFReader and compares all point and cell data with
what h5py reads. Exit status 0 if all agree, 1 if not. Needs h5py, numpy and vtk (9.3 or later).
"""

import argparse
import sys

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader


def frame_of(group, kind, name, step, count):
    """The values of one field in one frame, through the offsets the file gives."""
    begin = group[f"Steps/{kind}Offsets/{name}"][step]
    return group[f"{kind}/{name}"][begin : begin + count]


def compare_frame(group, grid, step):
    """Messages about the fields of one frame that VTK and h5py do not read alike."""
    complaints = []
    counts = {"PointData": grid.GetNumberOfPoints(), "CellData": grid.GetNumberOfCells()}
    for kind, attributes in (("PointData", grid.GetPointData()), ("CellData", grid.GetCellData())):
        for name in group.get(kind, {}):
            expected = frame_of(group, kind, name, step, counts[kind])
            array = attributes.GetArray(name)
            if array is None:
                complaints.append(f"frame {step}: VTK finds no {kind}/{name}")
            elif not np.array_equal(vtk_to_numpy(array), expected):
                complaints.append(f"frame {step}: {kind}/{name} differs")
    return complaints


def compare_lists(path):
    """Messages about lists of frames with too few or too many entries, on which VTK may crash."""
    with h5py.File(path, "r") as file:
        steps = file["VTKHDF/Steps"]
        expected = int(steps.attrs["NSteps"])
        lengths = {}
        steps.visititems(
            lambda name, item: lengths.update({name: len(item)})
            if isinstance(item, h5py.Dataset)
            else None
        )
    complaints = [
        f"{path}: NSteps is {expected}, Steps/{name} has {length} entries"
        for name, length in lengths.items()
        if length != expected
    ]
    return complaints if expected > 0 else [*complaints, f"{path}: no frames"]


def check(path):
    """Messages about all that is wrong with the file, and the number of frames."""
    complaints = compare_lists(path)
    if complaints:
        return complaints, 0
    reader = vtkHDFReader()
    if not reader.CanReadFile(path):
        return [f"{path}: VTK cannot read it"], 0
    reader.SetFileName(path)
    reader.UpdateInformation()
    key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key) or ()
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        expected = group["Steps/Values"][: group["Steps"].attrs["NSteps"]]
        if len(expected) == 1 and not times:
            times = expected        # a single frame is to VTK one without time
        if not np.array_equal(times, expected):
            complaints.append(f"VTK finds the times {times}")
        for step in range(len(times)):
            reader.SetStep(step)
            reader.Update()
            grid = reader.GetOutputDataObject(0)
            if grid.GetNumberOfPoints() != group["NumberOfPoints"][0]:
                complaints.append(f"frame {step}: {grid.GetNumberOfPoints()} points")
            if grid.GetNumberOfCells() != group["NumberOfCells"][0]:
                complaints.append(f"frame {step}: {grid.GetNumberOfCells()} cells")
            complaints += compare_frame(group, grid, step)
    return complaints, len(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("result", help="result file of carom")
    path = parser.parse_args().result
    try:
        complaints, n_frames = check(path)
    except (OSError, KeyError) as error:
        complaints, n_frames = [f"{path}: {error}"], 0
    for complaint in complaints:
        print(complaint)
    if complaints:
        return 1
    print(f"{path}: VTK reads all {n_frames} frames")
    return 0


if __name__ == "__main__":
    sys.exit(main())
