"""NumPy to VTK and back: the one place where arrays cross over.

Works the same on VTK 9.2 to 9.7 and with or without PyVista, so only the plain C++ interface is used.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkIdList, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_TETRA,
    VTK_TRIANGLE,
    vtkCellArray,
    vtkPointSet,
    vtkPolyData,
    vtkUnstructuredGrid,
)

from tetraskel.errors import MeshError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.mesh import Triangulation

CELL_TYPE = {2: VTK_TRIANGLE, 3: VTK_TETRA}


def points_of(data: vtkPointSet) -> np.ndarray:
    """Coordinates (n, 3) of a data set, in their own type; none gives (0, 3)."""
    points = data.GetPoints()
    if points is None or points.GetNumberOfPoints() == 0:
        return np.empty((0, 3))
    return vtk_to_numpy(points.GetData())


def to_points(coordinates: np.ndarray) -> vtkPoints:
    """Double-precision VTK points; a third coordinate of 0 is added to 2D ones."""
    space = np.zeros((len(coordinates), 3))
    space[:, : coordinates.shape[1]] = coordinates
    points = vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(space, deep=1))
    return points


def to_cells(connectivity: np.ndarray, offsets: np.ndarray | None = None) -> vtkCellArray:
    """Cells of equal size from (m, k) ids, or of any size from ids and offsets."""
    if offsets is None:
        m, width = connectivity.shape
        offsets = np.arange(0, m * width + 1, width)
    cells = vtkCellArray()
    ids = np.ascontiguousarray(connectivity, np.int64).ravel()
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(offsets, np.int64), deep=1), numpy_to_vtkIdTypeArray(ids, deep=1)
    )
    return cells


def add_arrays(attributes, arrays: Mapping[str, np.ndarray]) -> None:
    """Put named arrays on point, cell or field data; ids as vtkIdType, flags as bytes."""
    for name, values in arrays.items():
        values = np.ascontiguousarray(values)
        if values.dtype == np.int64:
            array = numpy_to_vtkIdTypeArray(values, deep=1)
        else:
            array = numpy_to_vtk(values.astype(np.uint8) if values.dtype == bool else values, deep=1)
        array.SetName(name)
        attributes.AddArray(array)


def add_facts(data, facts: Mapping[str, int | float | str]) -> None:
    """Put single numbers and words on the field data."""
    for name, value in facts.items():
        if isinstance(value, str):
            words = vtkStringArray()
            words.SetName(name)
            words.InsertNextValue(value)
            data.GetFieldData().AddArray(words)
        else:
            add_arrays(data.GetFieldData(), {name: np.array([value])})


def fact(data, name: str, default: str) -> str:
    """A word from the field data."""
    words = data.GetFieldData().GetAbstractArray(name)
    return words.GetValue(0) if isinstance(words, vtkStringArray) and words.GetNumberOfValues() else default


def copy_rows(source, target, rows: np.ndarray, skip: tuple[str, ...] = ()) -> None:
    """Copy the given rows of every named array, and which of them are the active scalars."""
    for k in range(source.GetNumberOfArrays()):
        array = source.GetAbstractArray(k)
        if array is None or not array.GetName() or array.GetName() in skip:
            continue
        if isinstance(array, vtkDataArray):
            picked = array.NewInstance()
            picked.DeepCopy(numpy_to_vtk(np.ascontiguousarray(vtk_to_numpy(array)[rows])))
        else:
            picked = array.NewInstance()
            picked.SetNumberOfComponents(array.GetNumberOfComponents())
            picked.SetNumberOfTuples(len(rows))
            array.GetTuples(to_id_list(rows), picked)
        picked.SetName(array.GetName())
        target.AddArray(picked)
    scalars = source.GetScalars()
    if scalars is not None and scalars.GetName() and target.HasArray(scalars.GetName()):
        target.SetActiveScalars(scalars.GetName())


def to_id_list(rows: np.ndarray) -> vtkIdList:
    """A VTK id list."""
    ids = vtkIdList()
    ids.SetNumberOfIds(len(rows))
    for position, row in enumerate(rows.tolist()):
        ids.SetId(position, row)
    return ids


def array_of(attributes, name: str) -> np.ndarray | None:
    """A numeric array by name, or None."""
    array = attributes.GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def fill_grid(grid: vtkUnstructuredGrid, mesh: Triangulation) -> None:
    """Put points and cells of a triangulation into a grid."""
    grid.SetPoints(to_points(mesh.points))
    grid.SetCells(CELL_TYPE[mesh.dim], to_cells(mesh.simplices))


def mesh_of(data: vtkPointSet) -> Triangulation:
    """The triangulation a data set holds: tetrahedra, or triangles of one plane.

    Raises
    ------
    MeshError
        For any other cells; they are counted by type.
    """
    simplices = simplices_of(data)
    points = points_of(data).astype(np.float64)
    return triangulation_of(points, simplices)


def simplices_of(data: vtkPointSet) -> np.ndarray:
    """(m, 4) or (m, 3) point ids of a data set whose cells are all tetrahedra or all triangles; (0, 4) for no cells.

    Raises
    ------
    MeshError
        For any other cells; they are counted by type.
    """
    if data.GetNumberOfCells() == 0:
        return np.empty((0, 4), np.int64)
    cells = data.GetPolys() if isinstance(data, vtkPolyData) else data.GetCells()
    for dim, cell_type in CELL_TYPE.items():
        if _all_of(data, cells, cell_type):
            return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, dim + 1)
    raise MeshError(
        f"expected a mesh of tetrahedra only, or of triangles only, got {_count_by_type(data)}; "
        "convert it first (Tetrahedralize) or triangulate its points (DelaunayMesh)."
    )


def _all_of(data: vtkPointSet, cells: vtkCellArray, cell_type: int) -> bool:
    """Whether all cells are of one type, without looking at each."""
    if data.GetCellType(0) != cell_type:
        return False
    if isinstance(data, vtkUnstructuredGrid):
        return bool(data.IsHomogeneous())
    return cells.GetNumberOfCells() == data.GetNumberOfCells() and cells.IsHomogeneous() == 3


def _count_by_type(data: vtkPointSet) -> str:
    """Say how many cells there are of each type, plainly: `vtkHexahedron` is "hexahedron"."""
    counts = Counter(data.GetCellType(k) for k in range(data.GetNumberOfCells()))
    example = {data.GetCellType(k): k for k in range(data.GetNumberOfCells())}
    names = {kind: data.GetCell(k).GetClassName().removeprefix("vtk").lower() for kind, k in example.items()}
    return ", ".join(f"{count} of type {names[kind]}" for kind, count in sorted(counts.items()))
