"""Files in and out, by their suffix."""

from __future__ import annotations

import logging
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from tetraskel.cli.graph_formats import write_csv, write_graphml, write_ply, write_swc
from tetraskel.cli.outputs import STANDARD_INPUT
from tetraskel.cli.tables import read_standard_input, read_table
from tetraskel.cli.trial import try_to_read
from tetraskel.errors import InputError
from tetraskel.vtkfilters.convert import add_arrays, to_points

TABLES = (".csv", ".xyz", ".txt", ".npy")
DATA_SETS = (".vtp", ".vtu", ".vtk", ".vti", ".ply", ".obj", ".stl")
UNCHECKED = (".obj", ".stl", ".ply")  # VTK reads nothing from a broken one, and does not say so


def read(path: str, *, images: bool = False) -> vtkPointSet:
    """The points (and cells) of a file, or a table from standard input (-).

    An image comes as its grid points unless `images` are wanted as they are.

    Raises
    ------
    InputError
        When the file is not there, has an unknown suffix, or cannot be read.
    """
    if path == STANDARD_INPUT:
        return _data_of(read_standard_input())
    file = expect_file(path)
    return _data_of(read_table(file)) if file.suffix.lower() in TABLES else _read_data_set(file, images)


def read_points(path: str, *, images: bool = False) -> vtkPointSet:
    """What a result is to be made from; see `read`.

    Raises
    ------
    InputError
        When it cannot be read, or has no points: a result of nothing would look like one.
    """
    data = read(path, images=images)
    expect_points(data.GetNumberOfPoints(), path)
    return data


def expect_points(n_points: int, path: str) -> None:
    """Raise `InputError` when there are none."""
    if n_points == 0:
        name = "from standard input" if path == STANDARD_INPUT else f"in {str(path)!r}"
        raise InputError(f"expected points {name}, got none.")


def expect_file(path: str) -> Path:
    """The path of a file that is there and has a suffix we know.

    Raises
    ------
    InputError
        When it is not, or has not.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in TABLES + DATA_SETS:
        raise InputError(f"expected a file ending in {' '.join(DATA_SETS + TABLES)}, got {path!r}.")
    if not file.is_file():
        kind = "is a folder" if file.is_dir() else "does not exist"
        raise InputError(f"expected a file to read, got {path!r}, which {kind}.")
    return file


def _read_data_set(file: Path, images: bool) -> vtkPointSet:
    try_to_read(file, lambda: _read_by_vtk(file, images))
    return _read_by_vtk(file, images)


def _read_by_vtk(file: Path, images: bool) -> vtkPointSet:
    import pyvista

    try:
        with pyvista.VtkErrorCatcher(send_to_logging=False) as caught, silent_log():
            data = pyvista.read(str(file))
    except Exception as error:
        raise InputError(f"{str(file)!r} cannot be read as {file.suffix}: {_first_line(str(error))}") from error
    if caught.events:
        raise InputError(f"{str(file)!r} cannot be read as {file.suffix}: {_first_line(caught.events[0].alert)}")
    if isinstance(data, pyvista.ImageData) and images:
        return data
    if isinstance(data, pyvista.ImageData):
        data = data.cast_to_structured_grid()
    if not isinstance(data, vtkPointSet):
        raise InputError(
            f"expected one data set with points in {str(file)!r}, got {type(data).__name__}; extract a block."
        )
    if data.GetNumberOfPoints() == 0 and file.suffix.lower() in UNCHECKED:
        raise InputError(f"expected points in {str(file)!r}, got none; is it a {file.suffix} file?")
    _expect_whole_cells(data, file)
    return data


def _expect_whole_cells(data: vtkPointSet, file: Path) -> None:
    """Raise `InputError` when cells name points that are not there: what follows would read beyond the arrays."""
    if isinstance(data, vtkPolyData):
        kinds = [data.GetVerts(), data.GetLines(), data.GetPolys(), data.GetStrips()]
    else:
        kinds = [data.GetCells()] if isinstance(data, vtkUnstructuredGrid) else []
    for cells in kinds:
        if cells is None or cells.GetNumberOfCells() == 0:
            continue
        offsets, ids = (vtk_to_numpy(array) for array in (cells.GetOffsetsArray(), cells.GetConnectivityArray()))
        in_order = offsets[0] == 0 and (np.diff(offsets) >= 0).all() and offsets[-1] <= len(ids)
        if not in_order or (len(ids) and not 0 <= ids.min() <= ids.max() < data.GetNumberOfPoints()):
            raise InputError(
                f"expected cells of the {data.GetNumberOfPoints()} points in {str(file)!r}, got some that name others."
            )


def _first_line(text: str) -> str:
    """What VTK complains of, without where in its source it does so, as the end of a sentence."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and "Generic Warning: In " not in line]
    return (lines[0].rstrip(" .:;") if lines else "no reason given") + "."


@contextmanager
def silent_log() -> Iterator[None]:
    """Keep VTK's log off standard error: what matters is raised in one line."""
    before, silenced = vtkLogger.GetCurrentVerbosityCutoff(), logging.root.manager.disable
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    logging.disable(logging.CRITICAL)  # PyVista tells Python's log, too
    try:
        yield
    finally:
        logging.disable(silenced)
        vtkLogger.SetStderrVerbosity(before)


def _data_of(table: tuple[np.ndarray, dict[str, np.ndarray]]) -> vtkPolyData:
    coordinates, others = table
    data = vtkPolyData()
    data.SetPoints(to_points(coordinates))
    add_arrays(data.GetPointData(), others)
    return data


def writer_for(path: str, writers: dict | None = None) -> Callable[[vtkPolyData], None]:
    """What writes polygonal data to `path`, with one of `writers` by suffix; asked for before any work is done.

    Raises
    ------
    InputError
        When the suffix is unknown or the file cannot be written.
    """
    writers = WRITERS if writers is None else writers
    check_output(path, tuple(writers))
    return replace_to(path, writers[Path(path).suffix.lower()])


def check_output(path: str, suffixes: tuple[str, ...]) -> None:
    """Raise `InputError` when an output file could not be written, before any work is done."""
    file = Path(path)
    if file.suffix.lower() not in suffixes:
        raise InputError(f"expected an output file ending in {' '.join(suffixes)}, got {path!r}.")
    if not file.resolve().parent.is_dir():
        raise InputError(f"expected a folder to write into, got {str(file.parent)!r}, which does not exist.")
    if file.is_dir():
        raise InputError(f"expected a file to write, got {path!r}, which is a folder.")
    if not os.access(file if file.exists() else file.resolve().parent, os.W_OK):
        raise InputError(f"expected a place to write to, got {path!r}, which is read-only.")


def replace_file(file: Path, write: Callable[[Path], None]) -> None:
    """Write beside the file and move it there when it is whole, so that a failure leaves the old one."""
    target = file.resolve()  # what a link points to, not the link
    part: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=".tetraskel-", suffix=file.suffix)
        os.close(handle)
        part = Path(name)
        write(part)
        part.chmod(target.stat().st_mode if target.exists() else 0o666 & ~_umask())
        part.replace(target)
    except OSError as error:
        raise InputError(f"{str(file)!r} could not be written: {error.strerror}.") from error
    finally:
        if part is not None:
            part.unlink(missing_ok=True)


def replace_to(path: str, write: Callable[[vtkPolyData, Path], None]) -> Callable[[vtkPolyData], None]:
    """What writes data to `path` in one move."""
    return lambda data: replace_file(Path(path), lambda part: write(data, part))


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def write_vtk(writer, data: vtkPolyData, path: Path) -> None:
    """Let one of VTK's writers write."""
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    if writer.Write() != 1:
        raise InputError(f"{str(path)!r} could not be written; is there room on the disk?")


WRITERS = {
    ".vtp": lambda data, path: write_vtk(vtkXMLPolyDataWriter(), data, path),
    ".vtk": lambda data, path: write_vtk(vtkPolyDataWriter(), data, path),
    ".csv": write_csv,
    ".swc": write_swc,
    ".graphml": write_graphml,
    ".ply": write_ply,
}


def write_by_suffix(data: vtkPolyData, path: Path) -> None:
    """Write to a path with one of the suffixes of `WRITERS`."""
    WRITERS[path.suffix.lower()](data, path)
