"""Skeletons as input of a command: polygonal data with radii, or SWC."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.cli.files import expect_points, read_points
from tetraskel.errors import InputError
from tetraskel.vtkfilters.convert import add_arrays, to_cells, to_points

COLUMNS = 7  # number, type, x, y, z, radius, number of the parent


def read_skeleton(path: str, radius_array: str) -> vtkPolyData:
    """The lines and radii of a file; those of SWC are called as `radius_array` says.

    Raises
    ------
    InputError
        When the file cannot be read or holds no polygonal data.
    """
    if Path(path).suffix.lower() == ".swc" and Path(path).is_file():
        data = read_swc(Path(path), radius_array)
        expect_points(data.GetNumberOfPoints(), path)
        return data
    data = read_points(path)
    if not isinstance(data, vtkPolyData):
        raise InputError(f"expected a skeleton as polygonal data in {path!r}, got {type(data).__name__}.")
    return data


def read_swc(file: Path, radius_array: str) -> vtkPolyData:
    """A row per point: number, type, x, y, z, radius, number of the parent or -1; `#` begins a comment.

    Raises
    ------
    InputError
        For rows that are none, numbers given twice, and parents that are not there.
    """
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"expected a text file in UTF-8, got {str(file)!r} in another encoding.") from error
    rows = [_row(file, k, line) for k, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    table = np.array(rows, dtype=float).reshape(-1, COLUMNS)
    index = {int(number): k for k, number in enumerate(table[:, 0].tolist())}
    if len(index) < len(table):
        raise InputError(f"expected every point of {str(file)!r} once, got {len(table) - len(index)} numbers twice.")
    sons = np.flatnonzero(table[:, 6] >= 0)
    lost = [int(parent) for parent in table[sons, 6].tolist() if int(parent) not in index]
    if lost:
        raise InputError(f"expected every parent in {str(file)!r} among its points, got {lost[0]}, which is not there.")
    parents = np.array([index[int(parent)] for parent in table[sons, 6].tolist()], dtype=np.int64)
    data = vtkPolyData()
    data.SetPoints(to_points(table[:, 2:5]))
    data.SetLines(to_cells(np.stack([parents, sons], axis=1)))
    add_arrays(data.GetPointData(), {radius_array: table[:, 5].copy()})
    return data


def _row(file: Path, number: int, line: str) -> list[float]:
    words = line.split("#")[0].split()
    try:
        numbers = [float(word) for word in words[:COLUMNS]]
        if len(words) >= COLUMNS and np.isfinite(numbers).all():
            return numbers
    except ValueError:
        pass
    raise InputError(f"expected seven finite numbers in line {number} of {str(file)!r}, got {line.strip()!r}.")
