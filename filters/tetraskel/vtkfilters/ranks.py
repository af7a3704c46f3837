"""Data sets on several MPI ranks: who takes part, which points and cells count, and all of them on one rank."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_BIT, VTK_ID_TYPE, vtkCharArray, vtkDataArray, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_TETRA,
    vtkCellArray,
    vtkDataSetAttributes,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkAppendFilter, vtkAppendPolyData
from vtkmodules.vtkParallelCore import vtkCommunicator, vtkMultiProcessController

from tetraskel.distributed.communicator import Route
from tetraskel.errors import EngineError, InputError
from tetraskel.vtkfilters.convert import add_arrays, array_of, copy_rows, points_of, to_cells, to_points
from tetraskel.vtkfilters.found import whole_input

GHOSTS = "vtkGhostType"
POINT_IDS, CELL_IDS = "GlobalPointIds", "GlobalCellIds"


def communicator_for(algorithm):
    """The ranks that execute a filter together; None for one rank, and for composite data.

    The blocks of composite data are objects: each is the work of the rank that has it, and ranks may have different
    numbers of them.
    """
    controller = vtkMultiProcessController.GetGlobalController()
    if controller is None or controller.GetNumberOfProcesses() < 2:
        return None
    given = whole_input(algorithm)
    if given is not None and given.IsA("vtkCompositeDataSet"):
        return None
    try:
        from vtkmodules.vtkParallelMPI4Py import vtkMPI4PyCommunicator
    except ImportError as error:
        raise EngineError(f"several MPI ranks need mpi4py, which this VTK has not ({error}); use one rank.") from error
    from tetraskel.distributed.mpi import MpiCommunicator

    return MpiCommunicator(vtkMPI4PyCommunicator.ConvertToPython(controller.GetCommunicator()))


def own_points(data) -> np.ndarray:
    """Indices of the points that are not copies of another rank's."""
    return _not_marked(data.GetPointData(), data.GetNumberOfPoints(), vtkDataSetAttributes.DUPLICATEPOINT)


def own_cells(data) -> np.ndarray:
    """Indices of the cells that are not copies of another rank's."""
    return _not_marked(data.GetCellData(), data.GetNumberOfCells(), vtkDataSetAttributes.DUPLICATECELL)


def _not_marked(attributes, n: int, mark: int) -> np.ndarray:
    ghosts = array_of(attributes, GHOSTS)
    return np.arange(n) if ghosts is None else np.flatnonzero((ghosts & np.uint8(mark)) == 0)


def global_ids(attributes) -> np.ndarray | None:
    """The ids that VTK keeps to name points or cells on all ranks, or None."""
    ids = attributes.GetGlobalIds()
    return None if ids is None else vtk_to_numpy(ids).astype(np.int64)


def numbered_points(comm, data) -> tuple[np.ndarray, np.ndarray]:
    """This rank's points without copies, as indices, and an id for each among all ranks.

    Ids are the global ids where the data have them, else the points are numbered rank after rank.
    """
    own = own_points(data)
    ids = global_ids(data.GetPointData())
    lacking = comm.total(int(len(own) > 0 and ids is None))
    if lacking:
        return own, comm.before(len(own)) + np.arange(len(own), dtype=np.int64)
    return own, (np.empty(0, np.int64) if ids is None else ids[own])


def set_global_ids(attributes, ids: np.ndarray, name: str) -> None:
    """Name points or cells among all ranks, as VTK does."""
    array = numpy_to_vtk(np.ascontiguousarray(ids, np.int64), deep=1, array_type=VTK_ID_TYPE)
    array.SetName(name)
    attributes.SetGlobalIds(array)


def mark_copies(attributes, copies: np.ndarray, mark: int) -> None:
    """Mark points or cells as copies of another rank's, as VTK does."""
    array = numpy_to_vtk(np.where(copies, mark, 0).astype(np.uint8), deep=1)
    array.SetName(GHOSTS)
    attributes.AddArray(array)


def name_points_alike(source, target) -> None:
    """Give points the global ids and the marks of the same points in another data set."""
    ids, ghosts = global_ids(source.GetPointData()), array_of(source.GetPointData(), GHOSTS)
    if ids is not None:
        set_global_ids(target.GetPointData(), ids, source.GetPointData().GetGlobalIds().GetName())
    if ghosts is not None:
        add_arrays(target.GetPointData(), {GHOSTS: ghosts})


def own_arrays(data) -> tuple[str, ...]:
    """Cell arrays that name cells among all ranks, or mark copies of them."""
    ids = data.GetCellData().GetGlobalIds()
    return (GHOSTS,) if ids is None else (GHOSTS, ids.GetName())


def fetched_arrays(comm, attributes, owners: np.ndarray, indices: np.ndarray, rows: np.ndarray) -> dict:
    """Rows of other ranks' numeric arrays, of each array that all ranks with arrays have.

    Parameters
    ----------
    owners, indices : (k,) int
        Rank that has each row wanted, and which one it is of those that the rank offers.
    rows : (r,) int
        The rows this rank offers.
    """
    own = _described(attributes)
    said = "\n".join(own) if len(rows) else ""
    texts = [bytes(text).decode() for text in comm.allgather(np.frombuffer(said.encode(), np.uint8))]
    lists = [set(text.split("\n")) for text in texts if text]
    common = sorted(set.intersection(*lists)) if lists else []
    route = Route(comm, owners)
    wanted = route.forward(indices)
    fetched = {}
    for description in common:
        name, kind, width = description.rsplit("\t", 2)
        empty = np.empty((0,) if width == "1" else (0, int(width)), kind)
        values = own.get(description, empty)[rows] if len(rows) else empty
        fetched[name] = route.back(np.ascontiguousarray(values[wanted]))
    return fetched


def gathered_points(comm, data, own: np.ndarray, ids: np.ndarray):
    """The points `own` of all ranks with their numeric arrays, on the first rank, in the order of their ids; the ids.

    Of points with one id one is kept. Coordinates keep their type where it is one.
    """
    counts = np.concatenate(comm.allgather(np.array([len(own)])))
    single = len(own) > 0 and points_of(data).dtype != np.float32
    kind = np.float64 if comm.total(int(single)) else np.float32
    points, all_ids = comm.gather(points_of(data)[own].astype(np.float64)), comm.gather(ids)
    first, order = np.unique(all_ids, return_index=True)
    owners = np.repeat(np.arange(comm.size), counts)
    indices = np.arange(len(owners)) - np.repeat(np.cumsum(counts) - counts, counts)
    arrays = fetched_arrays(comm, data.GetPointData(), owners[order], indices[order], own)
    if comm.rank != 0:
        return None, first
    cloud = vtkPolyData()
    cloud.SetPoints(vtkPoints())
    cloud.GetPoints().SetData(numpy_to_vtk(points[order].astype(kind), deep=1))
    add_arrays(cloud.GetPointData(), arrays)
    cloud.GetFieldData().PassData(data.GetFieldData())
    return cloud, first


def _described(attributes) -> dict[str, np.ndarray]:
    """Numeric arrays by their name, type and number of components."""
    found = {}
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(k)
        if isinstance(array, vtkDataArray) and array.GetName() and array.GetName() not in (GHOSTS, POINT_IDS):
            values = vtk_to_numpy(array) if array.GetDataType() != VTK_BIT else None  # bits have no NumPy type
            if values is not None:
                found[f"{array.GetName()}\t{values.dtype.str}\t{array.GetNumberOfComponents()}"] = values
    return found


def gathered(comm, data):
    """The pieces of all ranks as one data set, on the first rank; None on the others.

    Copies of cells are left out. Where points have global ids, those with one id become one point, and they are in the
    order of their ids; cells too.

    Raises
    ------
    InputError
        For data on several ranks that are neither polygonal nor an unstructured grid.
    """
    message = _marshalled(data) if data.GetNumberOfPoints() else np.empty(0, np.uint8)
    lengths, pieces = comm.gather(np.array([len(message)])), comm.gather(message)
    if comm.rank != 0:
        return None
    parts = [_unmarshalled(piece) for piece in np.split(pieces, np.cumsum(lengths)[:-1]) if len(piece)]
    if not parts:
        return data
    whole = parts[0] if len(parts) == 1 else _appended(parts)
    if not isinstance(whole, (vtkPolyData, vtkUnstructuredGrid)):
        return whole
    return _in_order_of_ids(whole)


def _marshalled(data) -> np.ndarray:
    """A data set without copied cells, as bytes. Global ids become plain arrays, which no filter leaves out."""
    plain = data.NewInstance()
    plain.ShallowCopy(data)
    for attributes, name in ((plain.GetPointData(), POINT_IDS), (plain.GetCellData(), CELL_IDS)):
        ids = global_ids(attributes)
        if ids is not None:
            attributes.RemoveArray(attributes.GetGlobalIds().GetName())
            add_arrays(attributes, {name: ids})
    if plain.GetCellData().HasArray(GHOSTS):
        plain.RemoveGhostCells()
    text = vtkCharArray()
    vtkCommunicator.MarshalDataObject(plain, text)
    return vtk_to_numpy(text).view(np.uint8).copy()


def _unmarshalled(message: np.ndarray):
    text = vtkCharArray()
    text.DeepCopy(numpy_to_vtk(message.view(np.int8), deep=1))
    data = vtkCommunicator.UnMarshalDataObject(text)
    if isinstance(data, vtkUnstructuredGrid) and data.GetNumberOfCells() == 0:
        data.SetCells(VTK_TETRA, vtkCellArray())  # without its own list of none vtkAppendFilter crashes
    return data


def _appended(parts):
    if not all(isinstance(part, (vtkPolyData, vtkUnstructuredGrid)) for part in parts):
        raise InputError(
            f"expected polygonal data or an unstructured grid on several ranks, got {parts[0].GetClassName()}; "
            "use one rank, or append the pieces."
        )
    _describe_no_cells_alike(parts)
    append = vtkAppendPolyData() if isinstance(parts[0], vtkPolyData) else vtkAppendFilter()
    for part in parts:
        append.AddInputData(part)
    append.Update()
    whole = append.GetOutput()
    whole.GetFieldData().ShallowCopy(parts[0].GetFieldData())
    return whole


def _describe_no_cells_alike(parts) -> None:
    """Give pieces without cells the cell arrays that others have, or appending would leave these out."""
    like = next((part for part in parts if part.GetNumberOfCells()), None)
    for part in parts if like is not None else ():
        if part.GetNumberOfCells() == 0:
            part.GetCellData().CopyStructure(like.GetCellData())


def _in_order_of_ids(data):
    """Points and cells in the order of their global ids, points with one id merged; data without ids as they are."""
    ids = array_of(data.GetPointData(), POINT_IDS)
    if ids is None:
        return data
    _, rows, new_id = np.unique(ids, return_index=True, return_inverse=True)
    merged = data.NewInstance()
    merged.SetPoints(to_points(points_of(data)[rows]))
    copy_rows(data.GetPointData(), merged.GetPointData(), rows, (GHOSTS, POINT_IDS))
    merged.GetFieldData().ShallowCopy(data.GetFieldData())
    cell_ids = array_of(data.GetCellData(), CELL_IDS)
    if isinstance(data, vtkUnstructuredGrid) and data.GetNumberOfCells() and data.IsHomogeneous():
        width = data.GetCells().GetConnectivityArray().GetNumberOfValues() // data.GetNumberOfCells()
        cells = new_id.reshape(-1)[vtk_to_numpy(data.GetCells().GetConnectivityArray())].reshape(-1, width)
        order = np.arange(len(cells)) if cell_ids is None else np.argsort(cell_ids, kind="stable")
        merged.SetCells(data.GetCellType(0), to_cells(cells[order]))
        copy_rows(data.GetCellData(), merged.GetCellData(), order, (GHOSTS, CELL_IDS))
        return merged
    return _with_cells_renumbered(data, merged, new_id.reshape(-1))


def _with_cells_renumbered(data, merged, new_id):
    if isinstance(data, vtkPolyData):
        for kind in ("Verts", "Lines", "Polys", "Strips"):
            cells = getattr(data, f"Get{kind}")()
            getattr(merged, f"Set{kind}")(_renumbered(cells, new_id))
    elif data.GetNumberOfCells():
        merged.SetCells(data.GetCellTypesArray(), _renumbered(data.GetCells(), new_id))
    merged.GetCellData().PassData(data.GetCellData())
    merged.GetCellData().RemoveArray(CELL_IDS)
    return merged


def _renumbered(cells, new_id):
    if cells.GetNumberOfCells() == 0:
        return cells
    return to_cells(new_id[vtk_to_numpy(cells.GetConnectivityArray())], vtk_to_numpy(cells.GetOffsetsArray()))
