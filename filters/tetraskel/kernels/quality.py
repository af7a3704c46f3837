"""How far a simplex is from flat, and the balls around and inside it."""

from __future__ import annotations

from itertools import combinations
from math import factorial, sqrt

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.predicates import determinant

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# beta of the quality, which makes it 1 for the regular simplex: sqrt(3)/216 (the paper, definition 5) for
# beta h**3 / V in 3D and sqrt(3)/12 for beta h**2 / A in 2D.
BETA = {2: sqrt(3) / 12, 3: sqrt(3) / 216}


def volumes(mesh: Triangulation) -> Floats:
    """(m,) volume (area in 2D) of each simplex, in the cube (square) of the length unit; never negative."""
    found = np.empty(len(mesh))
    axes = list(mesh.coordinates.T)

    def measure(piece: slice) -> None:
        found[piece] = np.abs(_signed(_corners(axes, mesh, piece)))

    for_chunks(measure, len(mesh))
    return found


def qualities(mesh: Triangulation, tick: Tick = silent) -> Floats:
    """(m,) quality 1/Qk of each simplex: 1 for the regular one, 0 for a flat one; no unit.

    Qk = beta h**d / V, h the root of the sum of the squared edge lengths, V the volume. VTK's `vtkMeshQuality` and
    ParaView's Cell Quality call Qk "Aspect Gamma" for tetrahedra and "Aspect Frobenius" for triangles.
    """
    found = np.empty(len(mesh))
    axes, dim = list(mesh.coordinates.T), mesh.dim

    def measure(piece: slice) -> None:
        corners = _corners(axes, mesh, piece)
        squares = _sum_of_squared_edges(corners)
        volume = np.abs(_signed(corners))
        with np.errstate(invalid="ignore", divide="ignore"):
            size = squares if dim == 2 else squares * np.sqrt(squares)  # h**d; a power is rounded otherwise elsewhere
            found[piece] = np.where(squares > 0, volume / (BETA[dim] * size), 0.0)

    for_chunks(measure, len(mesh), tick)
    return found


def _corners(axes: list[Floats], mesh: Triangulation, piece: slice) -> list[Floats]:
    """Coordinates axis by axis, d arrays (d+1, chunk)."""
    vertices = np.ascontiguousarray(mesh.simplices[piece].T)
    return [axis[vertices] for axis in axes]


def _signed(corners: list[Floats]) -> Floats:
    dim = len(corners)
    rows = [[axis[vertex] - axis[0] for axis in corners] for vertex in range(1, dim + 1)]
    return np.asarray(determinant(rows) / factorial(dim))


def _sum_of_squared_edges(corners: list[Floats]) -> Floats:
    total = np.zeros(corners[0].shape[1])
    for i, j in combinations(range(len(corners) + 1), 2):
        for axis in corners:
            total += (axis[i] - axis[j]) ** 2
    return total
