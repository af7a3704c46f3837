"""The objects of the comparison: closed meshes with about as many points as asked, and how many loops they have."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyvista

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
from tubes import TUBES, Tube, distance_to

ANALYTIC = ("capsule", "bent tube", "y", "torus", "double torus", "helix", "tree")
GRID = 60  # cells along the longest side, to begin with


@dataclass(frozen=True)
class Thing:
    """A closed surface; `loops` by its Euler characteristic, `ends` where they are known."""

    name: str
    mesh: pyvista.PolyData
    ends: int | None
    tube: Tube | None = None

    @property
    def loops(self) -> int:
        return 1 - (self.mesh.n_points - self.mesh.n_cells // 2) // 2

    def resampled(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Points and triangles, about n points.

        An analytic object is contoured on another grid: decimation would leave no points along a straight tube. Other
        meshes are subdivided until they have more points, then decimated.
        """
        mesh = self.mesh
        if self.tube is not None:
            mesh = tube_mesh(self.tube, round(GRID * np.sqrt(n / mesh.n_points)))
            return np.asarray(mesh.points, float), mesh.regular_faces.astype(np.int64)
        while mesh.n_points < n:
            mesh = mesh.subdivide(1, "linear")
        if mesh.n_points > 1.02 * n:
            mesh = mesh.decimate(1 - n / mesh.n_points).clean()
        return np.asarray(mesh.points, float), mesh.regular_faces.astype(np.int64)


def tube_mesh(tube: Tube, cells: int = GRID) -> pyvista.PolyData:
    """The boundary of a union of tubes, by the contour of its distance."""
    corners, reach = np.concatenate(tube.axes), max(tube.radii)
    low, high = corners.min(axis=0) - 1.2 * reach, corners.max(axis=0) + 1.2 * reach
    step = float((high - low).max()) / cells
    grid = pyvista.ImageData(dimensions=np.ceil((high - low) / step).astype(int) + 1, spacing=(step,) * 3, origin=low)
    places = np.asarray(grid.points)
    grid["distance"] = np.min([distance_to(axis, places) - r for axis, r in zip(tube.axes, tube.radii, strict=True)], 0)
    mesh = grid.contour([0.0], scalars="distance").triangulate().clean()
    corners = np.asarray(mesh.points, float)[mesh.regular_faces]
    outward = np.einsum("ka,ka->k", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() > 0
    return mesh if outward else mesh.flip_faces()  # some programs take the other side for the inside


def things(folder: str | None, names: list[str]) -> Iterator[Thing]:
    """The analytic objects, then the meshes of a folder; those named, or all."""
    for name in ANALYTIC:
        if not names or name in names:
            tube = TUBES[name]()
            yield Thing(name, tube_mesh(tube), tube.ends, tube)
    for path in sorted(Path(folder).glob("*.obj")) if folder else []:
        if not names or path.stem in names:
            yield Thing(path.stem, pyvista.read(path).extract_surface(algorithm=None).triangulate().clean(), None)
