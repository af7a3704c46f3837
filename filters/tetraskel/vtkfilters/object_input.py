"""Points of a surface, or a mesh with a cell array Inside: how filters take the object they draw the skeleton of."""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkPointSet

from tetraskel.kernels.chunks import Tick
from tetraskel.kernels.interior import Bools, inside_of_object
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.triangulate import triangulate
from tetraskel.vtkfilters.convert import array_of, holds_simplices, mesh_of, points_of


def mesh_and_labels(source: vtkPointSet, tick: Tick, *, denoise: bool = False) -> tuple[Triangulation, Bools | None]:
    """The mesh that an unstructured grid holds with its array Inside, if it has one; else the points, triangulated."""
    if holds_simplices(source):
        return mesh_of(source), array_of(source.GetCellData(), "Inside")
    return triangulate(points_of(source), denoise=denoise, tick=tick), None


def mesh_and_inside(source: vtkPointSet, triangulating: Tick, telling: Tick) -> tuple[Triangulation, Bools | None]:
    """The same, with the inside of points found by gates; a mesh without labels (None) is inside everywhere.

    Where the gates find none, nothing is: an object without inside is an error of those who draw it.
    """
    mesh, labels = mesh_and_labels(source, triangulating)
    return mesh, labels if holds_simplices(source) else inside_of_object(mesh, tick=telling)
