"""Files in and out, by their suffix."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from tetraskel.errors import InputError
from tetraskel.vtkfilters.convert import add_arrays, points_of, to_points

TABLES = (".csv", ".xyz", ".txt", ".npy")
DATA_SETS = (".vtp", ".vtu", ".vtk", ".vti", ".ply", ".obj", ".stl")
SEPARATORS = re.compile(r"[,;\s]+")


def read(path: str) -> vtkPointSet:
    """The points (and cells) of a file.

    Raises
    ------
    InputError
        When the file is not there, has an unknown suffix, or cannot be read.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in TABLES + DATA_SETS:
        raise InputError(f"expected a file ending in {' '.join(DATA_SETS + TABLES)}, got {path!r}.")
    if not file.is_file():
        raise InputError(f"expected a file to read, got {path!r}, which does not exist.")
    return _read_table(file) if suffix in TABLES else _read_data_set(file)


def _read_data_set(file: Path) -> vtkPointSet:
    import pyvista

    try:
        with pyvista.VtkErrorCatcher(raise_errors=True):
            data = pyvista.read(str(file))
    except Exception as error:
        raise InputError(f"{str(file)!r} cannot be read as {file.suffix}: {_first_line(error)}") from error
    if isinstance(data, pyvista.ImageData):
        data = data.cast_to_structured_grid()
    if not isinstance(data, vtkPointSet):
        raise InputError(
            f"expected one data set with points in {str(file)!r}, got {type(data).__name__}; extract a block."
        )
    return data


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[-1] if lines else type(error).__name__


def _read_table(file: Path) -> vtkPolyData:
    names, table = _load_npy(file) if file.suffix.lower() == ".npy" else _load_text(file)
    columns = [names.index(axis) for axis in "xyz" if axis in names] or list(range(min(table.shape[1], 3)))
    if len(columns) < 2:
        raise InputError(f"expected two or three columns of coordinates in {str(file)!r}, got {len(columns)}.")
    data = vtkPolyData()
    data.SetPoints(to_points(table[:, columns]))
    others = {name: table[:, k].copy() for k, name in enumerate(names) if k not in columns and name}
    add_arrays(data.GetPointData(), others)
    return data


def _load_npy(file: Path) -> tuple[list[str], np.ndarray]:
    try:
        table = np.load(file, allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise InputError(f"{str(file)!r} is not a plain array file: {_first_line(error)}") from error
    if table.ndim != 2 or table.dtype.kind not in "fiub":
        raise InputError(
            f"expected numbers of shape (n, 2) or (n, 3) in {str(file)!r}, got {table.dtype} {table.shape}."
        )
    return [""] * table.shape[1], table.astype(np.float64)


def _load_text(file: Path) -> tuple[list[str], np.ndarray]:
    """Column names and rows of numbers separated by commas, semicolons or blanks.

    `#` begins a comment; a first row of words is a header.
    """
    try:
        lines = [line.split("#")[0].strip() for line in file.read_text(encoding="utf-8-sig").splitlines()]
    except UnicodeDecodeError as error:
        raise InputError(f"{str(file)!r} is not a text file of coordinates.") from error
    rows = [SEPARATORS.split(line) for line in lines if line]
    names: list[str] = []
    if rows and not _is_number(rows[0][0]):
        names = [word.strip('"').lower() for word in rows.pop(0)]
    try:
        table = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise InputError(
            f"expected rows of numbers, all of one length, in {str(file)!r}: {_first_line(error)}"
        ) from error
    table = table if table.size else np.empty((0, max(len(names), 3)))
    return names or [""] * table.shape[1], table


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def writer_for(path: str) -> Callable[[vtkPolyData], None]:
    """What writes polygonal data to `path`; asked for before any work is done.

    Raises
    ------
    InputError
        When the suffix is unknown or the folder is not there.
    """
    file = Path(path)
    if file.suffix.lower() not in WRITERS:
        raise InputError(f"expected an output file ending in {' '.join(WRITERS)}, got {path!r}.")
    check_folder(path)

    def write(data: vtkPolyData) -> None:
        replace_file(file, lambda part: WRITERS[file.suffix.lower()](data, part))

    return write


def check_folder(path: str) -> None:
    """Raise `InputError` when the folder of an output file is not there."""
    if not Path(path).resolve().parent.is_dir():
        raise InputError(f"expected a folder to write into, got {str(Path(path).parent)!r}, which does not exist.")


def replace_file(file: Path, write: Callable[[Path], None]) -> None:
    """Write beside the file and move it there when it is whole, so that a failure leaves the old one."""
    handle, name = tempfile.mkstemp(dir=file.resolve().parent, prefix=".tetraskel-", suffix=file.suffix)
    os.close(handle)
    part = Path(name)
    try:
        write(part)
        part.chmod(0o666 & ~_umask())
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _write_vtk(writer, data: vtkPolyData, path: Path) -> None:
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    if writer.Write() != 1:
        raise InputError(f"{str(path)!r} could not be written; is there room on the disk?")


def _write_csv(data: vtkPolyData, path: Path) -> None:
    """One row per node: coordinates, then every point array with one component."""
    import pyvista

    arrays = pyvista.wrap(data).point_data
    columns = {name: arrays[name] for name in arrays if arrays[name].ndim == 1}
    points = points_of(data)
    with path.open("w", encoding="utf-8") as stream:
        stream.write(",".join(["x", "y", "z", *columns]) + "\n")
        for row in zip(*points.T.tolist(), *(column.tolist() for column in columns.values()), strict=True):
            stream.write(",".join(map(repr, row)) + "\n")


WRITERS = {
    ".vtp": lambda data, path: _write_vtk(vtkXMLPolyDataWriter(), data, path),
    ".vtk": lambda data, path: _write_vtk(vtkPolyDataWriter(), data, path),
    ".csv": _write_csv,
}
