"""Nasty clouds as data sets and files, through every filter and every command."""

from __future__ import annotations

import contextlib
import io
import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyvista
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkBitArray, vtkOutputWindow, vtkStringArray, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes

from contracts import judged, time_limit
from nasty import Nasty
from tetraskel import TetraskelError, cli, vtkfilters
from tetraskel.options import INSIDES, RASTER_METHODS, VORONOI_METHODS
from tetraskel.vtkfilters import (
    BezierSkeleton,
    CurveSkeleton,
    DelaunayMesh,
    FlatTetraRemoval,
    InteriorCells,
    PointThinning,
    RasterSkeleton,
    SkeletonOutput,
    SkeletonSurface,
    TreeBuilder,
    VoronoiSkeleton,
)

Rng = np.random.Generator


def in_space(points: np.ndarray) -> np.ndarray:
    """Three coordinates, as VTK wants them."""
    given = np.asarray(points)
    given = given.astype(given.dtype.newbyteorder("=")) if given.dtype.kind == "f" else given.astype(float)
    given = given.astype(np.float32) if given.dtype.itemsize < 4 else given
    flat = np.zeros((len(given), 3), given.dtype)
    flat[:, : given.shape[1]] = given
    return flat


def with_arrays(data, rng: Rng) -> None:
    """Attributes as other programs leave them: NaN, words, bits, no name, ghosts, components."""
    n, m = data.GetNumberOfPoints(), data.GetNumberOfCells()
    for count, attributes in ((n, data.GetPointData()), (m, data.GetCellData())):
        for name, values in (
            ("Heat", np.full(count, np.nan)),
            ("Inside", rng.choice([0.0, 1.0, np.nan], count)),
            ("MaximumInscribedSphereRadius", rng.choice([0.1, 1.0, -1.0, np.nan], count)),
            ("ParentId", rng.integers(-1, max(count, 1), count)),
            ("", rng.random(count)),
            ("Flow", rng.random((count, 3)).astype(np.float32)),
            (vtkDataSetAttributes.GhostArrayName(), rng.integers(0, 2, count).astype(np.uint8)),
        ):
            if rng.random() < 0.35:
                array = numpy_to_vtk(values, deep=1)
                array.SetName(name or None)
                attributes.AddArray(array)
        if rng.random() < 0.3:
            words, bits = vtkStringArray(), vtkBitArray()
            for array, name in ((words, "Words"), (bits, "Bits")):
                array.SetName(name)
                array.SetNumberOfValues(count)
                attributes.AddArray(array)
            for k in range(count):
                words.SetValue(k, "x")
                bits.SetValue(k, k % 2)


def poly_data(points, rng: Rng):
    data = pyvista.PolyData()
    data.points = points
    n = len(points)
    kind = rng.integers(5)
    if kind == 1 and n:
        data.verts = np.column_stack([np.ones(n, int), np.arange(n)]).ravel()
    elif kind == 2 and n > 1:
        lines = [np.r_[k, rng.integers(0, n, k)] for k in rng.integers(1, 6, 3)]
        data.lines = np.concatenate(lines)
    elif kind == 3 and n > 3:
        faces = [np.r_[k, rng.integers(0, n, k)] for k in rng.integers(3, 6, 4)]
        data.faces = np.concatenate(faces)
    return data


def grid_of(points, rng: Rng):
    """An unstructured grid: of nothing, of tetrahedra, of triangles, or of all sorts."""
    n, kind = len(points), rng.integers(5)
    if n < 4 or kind == 0:
        return pyvista.PolyData(points).cast_to_unstructured_grid() if n else pyvista.UnstructuredGrid()
    if kind == 1:
        made = DelaunayMesh()
        made.SetInputDataObject(0, pyvista.PolyData(points))
        return pyvista.UnstructuredGrid(made.run())
    width, code = ((4, 10), (3, 5), (4, 9))[kind - 2]
    cells = rng.integers(0, n, (5, width))
    codes = rng.choice([9, 10], 5) if kind == 4 else np.full(5, code)  # quadrangles and tetrahedra
    return pyvista.UnstructuredGrid(np.column_stack([np.full(5, width), cells]).ravel(), codes.astype(np.uint8), points)


def image_of(points, rng: Rng):
    shape = rng.integers(1, 7, 3)
    data = pyvista.ImageData(dimensions=shape, spacing=rng.choice([1e-9, 1.0, 1e6], 3))
    data.point_data["mask"] = rng.choice([0.0, 0.0, 1.0, np.nan if rng.random() < 0.2 else 2.0], data.n_points)
    return data


def blocks_of(points, rng: Rng):
    blocks = pyvista.MultiBlock()
    blocks.append(poly_data(points[: len(points) // 2], rng))
    blocks.append(None)
    blocks.append(pyvista.PolyData())
    blocks.append(grid_of(points, rng))
    return blocks


def structured(points, rng: Rng):
    n = len(points) // 4
    data = pyvista.StructuredGrid()
    if n:
        data.points, data.dimensions = points[: 4 * n], (2, 2, n)
    return data


KINDS = (poly_data, poly_data, grid_of, grid_of, image_of, blocks_of, structured)


def data_of(points, rng: Rng):
    """A data set that holds the cloud."""
    data = KINDS[rng.integers(len(KINDS))](in_space(points), rng)
    if not isinstance(data, pyvista.MultiBlock):
        with_arrays(data, rng)
    return data


def chains(rng: Rng) -> list:
    """Filters one after another."""
    mesh = DelaunayMesh(joggle=float(rng.choice([0.0, 1e-6])), denoise=bool(rng.integers(2)))
    inside = InteriorCells(
        method=str(rng.choice(INSIDES)), extract=bool(rng.integers(2)), gate_arrays=bool(rng.integers(2))
    )
    tree = TreeBuilder(centre=str(rng.choice(["barycentre", "incentre", "circumcentre"])))
    raster = RasterSkeleton(method=str(rng.choice(RASTER_METHODS)), resolution=int(rng.integers(2, 20)))
    curve = CurveSkeleton(
        detail=float(rng.random()), sheets=bool(rng.integers(2)), root=str(rng.choice(["paper", "point"]))
    )
    surface = SkeletonSurface(max_cells=1000, cells_per_radius=1.0)
    voronoi = VoronoiSkeleton(method=str(rng.choice(VORONOI_METHODS)))
    flat = FlatTetraRemoval(threshold=float(rng.choice([0.0, 0.01, 1.0])))
    ends = [[tree, flat, SkeletonOutput()], [curve], [curve, BezierSkeleton()], [curve, surface], [voronoi], [raster]]
    end = ends[rng.integers(len(ends))]
    thin = PointThinning(most_points=int(rng.choice([100, 1000])))
    begins = [[mesh], [mesh], [mesh, inside], [inside], [thin, mesh]]
    alone = [[getattr(vtkfilters, name)()] for name in vtkfilters.__all__ if name != "SkeletonFilter"]
    if rng.random() < 0.3:
        return alone[rng.integers(len(alone))]
    return [*begins[rng.integers(len(begins))], *end]


def filtered(given: Nasty) -> str:
    """Run a chain of filters on a data set made of a cloud."""
    rng = np.random.default_rng(given.seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            data = data_of(given.array(), rng)
        except TetraskelError:
            return "error"
    steps = chains(rng) or [DelaunayMesh()]
    window, before = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    vtkOutputWindow.SetInstance(window)
    said = ""
    try:
        with warnings.catch_warnings(), time_limit():
            warnings.simplefilter("error")
            steps[0].SetInputDataObject(0, data)
            if rng.random() < 0.3 and steps[0].GetNumberOfInputPorts() > 1:
                steps[0].SetInputDataObject(1, poly_data(in_space(given.array()), rng))
            for first, second in pairwise(steps):
                second.SetInputConnection(0, first.GetOutputPort())
            try:
                result = steps[-1].run()
            except TetraskelError as error:
                said, result = str(error), None
    finally:
        vtkOutputWindow.SetInstance(before)
    lines = list(filter(None, window.GetOutput().splitlines()))
    assert all(line.split(":")[0] in vtkfilters.__all__ for line in lines), lines
    if result is not None:
        check_output(result)
    return judged(said)


def check_output(result) -> None:
    """Points that are numbers, and arrays as long as what they belong to."""
    if result.IsA("vtkCompositeDataSet"):
        for block in pyvista.wrap(result):
            if block is not None:
                check_output(block)
        return
    if result.GetPoints() is not None and result.GetNumberOfPoints():
        assert np.isfinite(vtk_to_numpy(result.GetPoints().GetData())).all(), "points that are no numbers"
    for count, attributes in (
        (result.GetNumberOfPoints(), result.GetPointData()),
        (result.GetNumberOfCells(), result.GetCellData()),
    ):
        for k in range(attributes.GetNumberOfArrays()):
            array = attributes.GetAbstractArray(k)
            assert array.GetNumberOfTuples() == count, f"{array.GetName()} is as long as something else"


COMMANDS = {
    "tree": ((".vtp", ".vtk", ".swc", ".graphml", ".ply", ".csv"), (["--traversal", "depth"], ["--joggle", "1e-6"])),
    "skeleton": (
        (".vtp", ".swc", ".graphml", ".ply", ".csv"),
        (["--method", "tree"], ["--detail", "1"], ["--inside", "all"], ["--inside", "array"], ["--points-only"]),
    ),
    "voronoi": ((".vtp", ".vtk", ".csv"), (["--method", "sk1"], ["--method", "sk2"], ["--inside", "all"])),
    "raster": (
        (".vtp", ".csv"),
        (
            ["--resolution", "8"],
            ["--resolution", "8", "--method", "distance"],
            ["--resolution", "4", "--inside", "all"],
        ),
    ),
    "thin": ((".vtp", ".vtk", ".csv"), ([], ["--most-points", "100"])),
    "surface": ((".vtp", ".ply", ".obj", ".stl"), (["--max-cells", "1000"],)),
    "bezier": ((".vtp", ".swc"), (["--tolerance", "0.5"],)),
    "compare": (("",), (["--methods", "tree", "--resolution", "4", "--inside", "all"],)),
    "measure": ((".vtp",), ([],)),
}
SWITCHES = ([], [], ["--json"])


def written(points, folder: Path, rng: Rng) -> Path:
    """The cloud as a file of one of the formats."""
    suffix = str(rng.choice([".csv", ".xyz", ".npy", ".txt", ".vtp", ".vtu", ".vtk", ".ply", ".obj", ".stl", ".vti"]))
    file = folder / f"cloud{suffix}"
    if suffix == ".npy":
        np.save(file, points)
    elif suffix in (".csv", ".xyz", ".txt"):
        separator = {".csv": ",", ".xyz": " ", ".txt": "\t"}[suffix]
        np.savetxt(file, np.asarray(points, float), delimiter=separator, fmt="%.17g")
    elif suffix == ".vti":
        image_of(points, rng).save(file)
    elif suffix == ".vtu" or (suffix == ".vtk" and rng.random() < 0.5):
        data = grid_of(in_space(points), rng)
        with_arrays(data, rng)
        data.save(file)
    else:
        data = poly_data(in_space(points), rng)
        if suffix in (".vtp", ".vtk"):
            with_arrays(data, rng)
        data.save(file)
    return file


def arguments_for(file: Path, folder: Path, rng: Rng) -> list[str]:
    """A call of a command on a file."""
    command = str(rng.choice(sorted(COMMANDS)))
    suffixes, options = COMMANDS[command]
    out = str(file) if command == "measure" else str(folder / f"out{rng.choice(suffixes)}")
    switches = [] if command in ("compare",) else SWITCHES[rng.integers(len(SWITCHES))]
    more = options[rng.integers(len(options))] if rng.random() < 0.6 or command == "compare" else []
    return [command, str(file), out, *more, *switches]


def told(arguments: list[str]) -> str:
    """Run a command in this process: "result" with a file that is there, or "error" with one line."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors), time_limit():
        try:
            status = cli.main(arguments)
        except SystemExit as left:
            status = left.code
    lines = [line for line in errors.getvalue().splitlines() if not line.startswith("warning: ")]
    assert status in (0, 2), f"left with {status}"
    if status:
        assert len(lines) == 1, lines
        assert lines[0].startswith(f"tetraskel {arguments[0]}: "), lines
        return judged(lines[0])
    assert not lines, lines
    assert out.getvalue().strip()
    assert Path(arguments[2]).exists()
    return "result"


def commanded(given: Nasty, folder: Path) -> str:
    """Write a cloud to a file and run a command on it."""
    rng = np.random.default_rng(given.seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            file = written(given.array(), folder, rng)
        except TetraskelError:
            return "error"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return told(arguments_for(file, folder, rng))
