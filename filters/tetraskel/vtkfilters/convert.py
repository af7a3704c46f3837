"""NumPy to VTK and back: the one place where arrays cross over.

Works the same on VTK 9.2 to 9.7 and with or without PyVista, so only the plain C++ interface is used.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkBitArray, vtkDataArray, vtkIdList, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_TETRA,
    VTK_TRIANGLE,
    vtkCellArray,
    vtkPointSet,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkTriangleFilter

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


def pass_facts(source, target) -> None:
    """Carry the field data that the target does not say itself."""
    own, attributes = target.GetFieldData(), source.GetFieldData()
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(k)
        if array is not None and not (array.GetName() and own.HasArray(array.GetName())):
            own.AddArray(array)


def single_facts(data) -> dict[str, int | float | str]:
    """The single finite numbers and words of the field data, by name."""
    found, attributes = {}, data.GetFieldData()
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(k)
        if array.GetNumberOfValues() != 1:
            continue
        value = array.GetValue(0) if isinstance(array, (vtkDataArray, vtkStringArray)) else None
        if isinstance(value, str) or (value is not None and np.isfinite(value)):
            found[array.GetName()] = value
    return found


def copy_rows(source, target, rows: np.ndarray, skip: tuple[str, ...] = ()) -> None:
    """Copy the given rows of every named array, and which of them are the active scalars."""
    for k in range(source.GetNumberOfArrays()):
        array = source.GetAbstractArray(k)
        if array is None or not array.GetName() or array.GetName() in skip:
            continue
        if isinstance(array, vtkDataArray) and not isinstance(array, vtkBitArray):
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
    mesh = triangulation_of(points_of(data), simplices_of(data))
    return replace(mesh, engine=fact(data, "Engine", mesh.engine))


def simplices_of(data: vtkPointSet) -> np.ndarray:
    """(m, 4) or (m, 3) point ids of a data set whose cells are all tetrahedra or all triangles; (0, 4) for no cells.

    Raises
    ------
    MeshError
        For any other cells; they are counted by type.
    """
    if data.GetNumberOfCells() == 0:
        return np.empty((0, 4), np.int64)
    for dim, cell_type in CELL_TYPE.items():
        if isinstance(data, (vtkPolyData, vtkUnstructuredGrid)) and _all_of(data, cell_type):
            cells = data.GetPolys() if isinstance(data, vtkPolyData) else data.GetCells()
            return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, dim + 1)
    raise MeshError(
        f"expected a mesh of tetrahedra only, or of triangles only, got {_count_by_type(data)}; "
        "convert it first (Tetrahedralize) or triangulate its points (DelaunayMesh)."
    )


def surface_of_data(data: vtkPointSet) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and triangles (t, 3) of polygonal data; polygons are split, lines left out."""
    if not isinstance(data, vtkPolyData):
        raise MeshError(f"expected a surface as polygonal data, got {data.GetClassName()}; extract its surface first.")
    triangles = vtkTriangleFilter()
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.SetInputData(data)
    triangles.Update()
    return points_of(triangles.GetOutput()), simplices_of(triangles.GetOutput())[:, :3]


def segments_of(cells: vtkCellArray, *, closed: bool) -> np.ndarray:
    """(s, 2) point ids of the edges along lines, or around polygons if `closed`."""
    if cells is None or cells.GetNumberOfCells() == 0:
        return np.empty((0, 2), np.int64)
    offsets, ids = (vtk_to_numpy(array) for array in (cells.GetOffsetsArray(), cells.GetConnectivityArray()))
    after = np.arange(1, len(ids) + 1)
    after[offsets[1:] - 1] = offsets[:-1]  # from the last point of a cell back to its first
    keep = np.ones(len(ids), bool)
    keep[offsets[1:] - 1] = closed
    return np.stack([ids, ids[after]], axis=1)[keep].astype(np.int64)


def holds_simplices(data: vtkPointSet) -> bool:
    """Whether a data set is a mesh to be taken as it is: an unstructured grid with more than points and lines."""
    if not isinstance(data, vtkUnstructuredGrid):
        return False
    n_looked_at = 1 if data.IsHomogeneous() else data.GetNumberOfCells()
    kinds = [data.GetCellType(k) for k in range(min(n_looked_at, data.GetNumberOfCells()))]
    return any(data.GetCell(k).GetCellDimension() > 1 for k, _ in _first_of_each(kinds))


def _all_of(data: vtkPointSet, cell_type: int) -> bool:
    """Whether all cells are of one type, without looking at each."""
    if data.GetCellType(0) != cell_type:
        return False
    if isinstance(data, vtkUnstructuredGrid):
        return bool(data.IsHomogeneous())
    cells = data.GetPolys()
    return cells.GetNumberOfCells() == data.GetNumberOfCells() and cells.IsHomogeneous() == 3


def _count_by_type(data: vtkPointSet) -> str:
    """Say how many cells there are of each type, plainly: `vtkHexahedron` is "hexahedron"."""
    kinds = [data.GetCellType(k) for k in range(data.GetNumberOfCells())]
    names = {kind: data.GetCell(k).GetClassName().removeprefix("vtk").lower() for k, kind in _first_of_each(kinds)}
    return ", ".join(f"{count} of type {names[kind]}" for kind, count in sorted(Counter(kinds).items()))


def _first_of_each(kinds: list[int]) -> list[tuple[int, int]]:
    """(position, kind) of the first cell of each kind."""
    values, first = np.unique(kinds, return_index=True)
    return list(zip(first.tolist(), values.tolist(), strict=True))
