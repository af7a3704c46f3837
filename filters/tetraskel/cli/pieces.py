"""Points of a file that may be larger than memory: a mapping of the file itself, or of a copy made piece by piece."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tetraskel.cli.files import TABLES, expect_file, read
from tetraskel.cli.outputs import STANDARD_INPUT
from tetraskel.cli.tables import open_npy, rows_of_table
from tetraskel.errors import InputError
from tetraskel.kernels.points import PIECE, checked_box
from tetraskel.vtkfilters.convert import holds_simplices, points_of


def mapped_points(path: str, folder: Path, *, points_only: bool) -> np.ndarray:
    """(n, 3) coordinates of a file, not in memory.

    Arrays (.npy) are used where they are. Tables (.csv .xyz .txt, and - for standard input) are read some lines at a
    time, all other files whole, and copied to a file in `folder` that goes with the result.

    Raises
    ------
    InputError
        When the file cannot be read, holds tetrahedra, is one of the plane, or holds coordinates that are not finite.
    """
    suffix = Path(path).suffix.lower()
    if path == STANDARD_INPUT:
        points = _copied(rows_of_table(sys.stdin.buffer, Path("standard input"), PIECE), folder)
    elif suffix == ".npy":
        points = open_npy(expect_file(path))
    elif suffix in TABLES:
        with open(expect_file(path), "rb") as stream:
            points = _copied(rows_of_table(stream, Path(path), PIECE), folder)
    else:
        points = _copied(iter([_points_of_data(path, points_only=points_only)]), folder)
    if points.shape[1] != 3:
        raise InputError("expected points in space with --blocks, got points of a plane; leave out --blocks.")
    checked_box(points)
    return points


def _points_of_data(path: str, *, points_only: bool) -> np.ndarray:
    data = read(path)
    if holds_simplices(data) and not points_only:
        raise InputError(
            f"expected points with --blocks, got a mesh in {path!r}; add --points-only to triangulate its points."
        )
    return points_of(data)


def _copied(pieces: Iterator[np.ndarray], folder: Path) -> np.ndarray:
    """The pieces, one after another, as a mapping of a file without a name."""
    width, kind, n = 3, np.dtype(float), 0
    with tempfile.TemporaryFile(dir=folder, prefix=".tetraskel-") as file:
        for piece in pieces:
            width, kind, n = piece.shape[1], piece.dtype, n + len(piece)
            try:
                file.write(np.ascontiguousarray(piece).tobytes())
                file.flush()
            except OSError as error:
                raise InputError(f"expected room for the points in {str(folder)!r}: {error.strerror}.") from error
        if n == 0:
            return np.empty((0, 3))
        return np.memmap(file, kind, "r", shape=(n, width))
