"""How bad input is given to a kernel, to a filter and to a command."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from unittest import mock

import numpy as np
import pyvista

import tetraskel
from tetraskel.kernels import curve
from tetraskel.kernels.ball_graph import BallGraph, ball_graph

RANDOM = np.random.default_rng(7).random((60, 3))
RADIUS = "MaximumInscribedSphereRadius"
TETRA, TRIANGLE = pyvista.CellType.TETRA, pyvista.CellType.TRIANGLE
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1], [1, 1, 1]], float)
FAR_AWAY = np.concatenate([np.random.default_rng(0).random((200, 3)), [[1e9, 0, 0]]])
IN_ONE_PLACE = (np.array([[0, 0, 0]] * 4 + [[1, 1, 1.0]]), np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
BETWEEN = np.array([[0.5, 0, 0], [0, 0.5, 0.1], [1, 0.5, 0], [0.5, 1, 1]])  # holds no corner of its box
OUTWARDS = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
BALLS = BallGraph(CORNERS[:2], np.full(2, 0.2), np.array([0, 2]), np.array([0, 1]))


@dataclass(frozen=True)
class Bad:
    """One kind of bad input.

    `kernel` raises; `data` is what a filter with `options` is given, with `second` at its second input, and `command`
    what a shell is told. `own` are the sentences of faces that notice earlier. Without data no filter can be given
    it, and `why` says why.
    """

    kernel: Callable
    data: Callable | None = None
    filter: str = "DelaunayMesh"
    options: dict = field(default_factory=dict)
    second: Callable | None = None
    command: str = "tree"
    own: dict[str, str] = field(default_factory=dict)
    why: str = ""


def cloud(points):
    return pyvista.PolyData(np.array(points, float))


def grid(points, cells, kind=TETRA, **arrays):
    data = pyvista.UnstructuredGrid({kind: np.array(cells)}, np.array(points, float))
    for name, values in arrays.items():
        data.cell_data[name] = values
    return data


def lines(points, radius, segments=((0, 1),)):
    rows = [len(one) for one in segments]
    data = pyvista.PolyData(np.array(points, float))
    data.lines = np.concatenate([[n, *one] for n, one in zip(rows, segments, strict=True)])
    data.point_data[RADIUS] = np.array(radius, float)
    return data


def surface(points, faces):
    return pyvista.PolyData.from_regular_faces(np.array(points, float), np.array(faces))


def image(values):
    data = pyvista.ImageData(dimensions=np.shape(values))
    data.point_data["mask"] = np.asarray(values).ravel(order="F")
    return data


def mesh_of(points=RANDOM):
    return tetraskel.triangulate(points)


def random_grid(**arrays):
    mesh = mesh_of()
    return grid(mesh.points, mesh.simplices, **{name: values(len(mesh)) for name, values in arrays.items()})


def flat_mesh():
    return tetraskel.triangulate(SQUARE)


def flat_grid():
    mesh = flat_mesh()
    return grid(mesh.points, mesh.simplices, TRIANGLE)


def bent_grid():
    return grid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], [[0, 1, 2], [1, 3, 2]], TRIANGLE)


def points_row(points, **more):
    return Bad(lambda: tetraskel.triangulate(points), lambda: cloud(points), **more)


def mesh_row(points, cells, kind=TETRA, kernel=tetraskel.build_tree):
    def run():
        return kernel(tetraskel.triangulation_of(np.array(points, float), np.array(cells)))

    return Bad(run, lambda: grid(points, cells, kind), "TreeBuilder")


def labels_row(labels, **more):
    def run():
        return tetraskel.interior(mesh_of(), method="array", labels=labels(len(mesh_of())))

    told = {
        "options": {"method": "array", "label_array": "Labels"},
        "command": "tree --inside array --label-array Labels",
    }
    return Bad(run, lambda: random_grid(Labels=labels), "InteriorCells", **told, **more)


def side_row(points, faces, mesh=None, **more):
    """A surface that cannot tell inside from outside."""

    def run():
        return tetraskel.interior(mesh_of() if mesh is None else mesh(), method="surface", surface=(points, faces))

    told = {"options": {"method": "surface"}, "second": lambda: surface(points, faces)}
    data = random_grid if mesh is None else flat_grid
    return Bad(run, data, "InteriorCells", **told, command="tree --inside surface --boundary", **more)


def outline_row(points, segments, mesh=flat_mesh, data=flat_grid, **more):
    def run():
        return tetraskel.inside_by_outline(mesh(), np.array(points, float), np.array(segments).reshape(-1, 2))

    def second():
        return lines(points, np.ones(len(points)), segments) if len(segments) else cloud(points)

    told = {"options": {"method": "outline"}, "second": second, "command": "tree --inside outline --boundary"}
    return Bad(run, data, "InteriorCells", **told, **more)


def balls_row(points, radius, **more):
    def run():
        offsets, ids = np.array([0, 2]), np.array([0, 1])
        return ball_graph(BallGraph(np.array(points, float), np.array(radius, float), offsets, ids))

    return Bad(run, lambda: lines(points, radius), "SkeletonSurface", command="surface", **more)


def against_row(points, **more):
    """A skeleton that is fine and an original that is not."""
    skeleton = lines(BALLS.points, BALLS.radius)

    def run():
        return tetraskel.surface_error(tetraskel.skeleton_surface(BALLS), np.array(points, float))

    told = {"second": lambda: cloud(np.reshape(points, (-1, 3))), "command": "surface --against"}
    return Bad(run, lambda: skeleton, "SkeletonSurface", **told, **more)


def mask_row(values, **more):
    def run():
        return tetraskel.raster_skeleton(values)

    return Bad(run, lambda: image(values), "RasterSkeleton", command="raster", **more)


def nothing_inside(kernel, filter_name, command):
    def run():
        mesh = mesh_of()
        return kernel(mesh, inside=np.zeros(len(mesh), bool))

    return Bad(run, lambda: random_grid(Inside=np.zeros), filter_name, command=command)


NO_NUMBERS = "arrays of VTK hold numbers, one each for a point, and points have three coordinates"
NO_OTHERS = "the filters give the kernels the right thing"
OTHERS = "an error of another package, which no input is known to cause"
OURS = "an error of ours, which no input is known to cause"
OFF = np.where(np.arange(180).reshape(60, 3) == 7, np.nan, RANDOM)
RING = np.zeros((3, 3, 3))


def square_model():
    return tetraskel.curve_model(tetraskel.triangulation_of(SQUARE[:, :2], [[0, 1, 2], [0, 2, 3]]))


def wrong_loops():
    curve.check_loops(replace(tetraskel.draw_curve(square_model()), loops=5))


def patched(target, value, kernel):
    """A kernel where something of another package does not do what it should."""

    def run():
        with mock.patch.dict(sys.modules, {target: value}) if value is None else mock.patch(target, value):
            return kernel()

    return run


def mesh_of_qhull():
    return tetraskel.triangulate(RANDOM, engine="qhull")


def ill_qhull(points):
    from scipy.spatial import QhullError

    raise QhullError("QH6154 initial simplex is flat")


def without_simplices(points, tick):
    return np.empty((0, 4), int), np.empty((0, 4), int), np.arange(len(points))


def with_a_point_less(points, **options):
    return tetraskel.triangulate(points[:-1], **options)


def around_the_square():
    """An outline the triangulation of a cloud does not follow by itself."""
    mesh = tetraskel.triangulate(RANDOM[:, :2])
    return tetraskel.inside_by_outline(mesh, 0.4 * SQUARE[:, :2] + 0.3, [[0, 1], [1, 2], [2, 3], [3, 0]])


def wrong_collapse():
    class Wrong:
        kept, n_punctures, n_nodes, euler_characteristic = np.ones(3, bool), 0, 2, 4

    curve.check_homotopy(Wrong, Wrong)
