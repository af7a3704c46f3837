"""Delaunay engines that can be compared: ours and the person's own, each a function of points."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

import numpy as np

Engine = Callable[[np.ndarray], int]


def scipy_qhull(points: np.ndarray) -> int:
    from scipy.spatial import Delaunay

    return len(Delaunay(points).simplices)


def exact(points: np.ndarray) -> int:
    from tetraskel.kernels.exact.engine import delaunay
    from tetraskel.kernels.points import morton_order

    return len(delaunay(points[morton_order(points)])[0])


def vtk_delaunay(points: np.ndarray) -> int:
    from tetraskel.vtkfilters.delaunay_engine import delaunay

    return len(delaunay(points, lambda share: None)[0])


def tetgen(points: np.ndarray) -> int:
    """Points and their hull: this wrapper of TetGen crashes when it is given points alone."""
    from scipy.spatial import ConvexHull
    from tetgen import TetGen  # type: ignore[import-not-found]

    mesh = TetGen(points, ConvexHull(points).simplices.astype(np.int32))
    return len(mesh.tetrahedralize(plc=True, quality=False)[1])


def gmsh(points: np.ndarray) -> int:
    import gmsh as program  # type: ignore[import-not-found]

    program.initialize()
    program.option.set_number("General.Verbosity", 1)
    try:
        return len(program.algorithm.tetrahedralize(points.ravel())[0]) // 4
    finally:
        program.finalize()


def cgal(points: np.ndarray) -> int:
    from CGAL.CGAL_Kernel import Point_3  # type: ignore[import-not-found]
    from CGAL.CGAL_Triangulation_3 import Delaunay_triangulation_3  # type: ignore[import-not-found]

    return Delaunay_triangulation_3([Point_3(*row) for row in points.tolist()]).number_of_finite_cells()


ENGINES: dict[str, tuple[str, Engine]] = {
    "Qhull": ("scipy", scipy_qhull), "exact": ("numba", exact), "vtkDelaunay3D": ("vtkmodules", vtk_delaunay),
    "TetGen": ("tetgen", tetgen), "gmsh": ("gmsh", gmsh), "CGAL": ("CGAL", cgal),
}  # fmt: skip


def installed() -> list[str]:
    return [name for name, (needed, _) in ENGINES.items() if importlib.util.find_spec(needed)]
