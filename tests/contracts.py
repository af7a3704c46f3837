"""What every public function promises of any cloud: a result that keeps its contract, or one `TetraskelError`.

A probe takes a cloud and random numbers, calls public functions and asserts what must hold of the results, whatever
the cloud. `kept` runs one and judges how it ended.
"""

from __future__ import annotations

import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

import tetraskel
from checks import euler_characteristic, hull_facets
from nasty import Nasty
from tetraskel import InsideWarning, TetraskelError
from tetraskel.kernels.adjacency import is_mesh
from tetraskel.kernels.curve import CurveModel
from tetraskel.options import CENTRES, COMPARED, ELEMENTS, RASTER_METHODS, TRAVERSALS, VORONOI_METHODS

Rng = np.random.Generator
HANGS = 30.0  # seconds for a cloud of a hundred points


class BrokenError(AssertionError):
    """A contract that was not kept."""


@contextmanager
def time_limit(seconds: float = HANGS) -> Iterator[None]:
    """Fail in the main thread instead of hanging."""

    def stop(*_):
        raise BrokenError(f"not done after {seconds:g} seconds")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def is_sentence(text: str) -> bool:
    """One line that says something and ends."""
    return len(text) > 15 and "\n" not in text.strip() and text.rstrip()[-1] in ".?"


def kept(probe: Callable, given: Nasty) -> str:
    """Run a probe on a cloud: "result", or "error" where it was refused in one sentence; all else is raised."""
    points = given.array()
    before = points.tobytes()
    with warnings.catch_warnings(), time_limit():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", InsideWarning)
        try:
            probe(points, np.random.default_rng(given.seed))
            said = ""
        except TetraskelError as error:
            said = str(error)
    assert points.tobytes() == before, "the input was changed"
    return judged(said)


def judged(said: str) -> str:
    """How a call ended that said this: one good sentence, or nothing."""
    assert not said or is_sentence(said), f"no sentence: {said}"
    assert "report" not in said, f"the program says itself that it is wrong: {said}"
    return "error" if said else "result"


def check_mesh(mesh: tetraskel.Triangulation, n: int) -> None:
    assert np.isfinite(mesh.points).all()
    assert len(mesh.point_map) == n
    if n == 0:
        return
    assert mesh.point_map.min() >= 0
    assert mesh.point_map.max() < len(mesh.points)
    assert len(np.unique(mesh.simplices)) == len(mesh.points)
    assert (mesh.neighbors >= -1).all()
    assert (mesh.neighbors < len(mesh)).all()
    assert is_mesh(mesh.simplices, mesh.neighbors)
    assert euler_characteristic(mesh.simplices) == 1, "not a ball"


def random_mesh(points: NDArray, rng: Rng) -> tetraskel.Triangulation:
    joggle = float(rng.choice([0.0, 0.0, 1e-6, 0.01]))
    return tetraskel.triangulate(points, joggle=joggle, denoise=bool(rng.integers(2)))


def labels_of(mesh: tetraskel.Triangulation, rng: Rng) -> NDArray:
    """Some inside, in one of the forms in which labels come."""
    kind = rng.integers(4)
    if kind == 0:
        return np.ones(len(mesh), bool)
    if kind == 1:
        return rng.integers(0, 2, len(mesh))
    if kind == 2:
        return (mesh.points[mesh.simplices].mean(axis=1) @ rng.normal(size=mesh.points.shape[1]) > 0).astype(np.uint8)
    return tetraskel.interior(mesh)


def probe_triangulate(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    check_mesh(mesh, len(points))
    order = rng.permutation(len(points))
    again = tetraskel.triangulate(points[order])
    other = tetraskel.triangulate(points)
    assert np.array_equal(np.sort(ordered(again)), np.sort(ordered(other))), "depends on the order of the points"


def ordered(mesh: tetraskel.Triangulation) -> NDArray:
    """Corners of the simplices in an order of their own."""
    if len(mesh) == 0:
        return np.empty(0)
    rank = np.empty(len(mesh.points), int)
    rank[np.lexsort(mesh.points.T)] = np.arange(len(mesh.points))
    cells = np.sort(rank[mesh.simplices], axis=1)
    return cells[np.lexsort(cells.T)]


def probe_tree(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    tree = tetraskel.build_tree(mesh, traversal=str(rng.choice(TRAVERSALS)))
    assert np.array_equal(np.sort(tree.cell), np.arange(len(mesh)))
    decoded = tetraskel.decode_tree(tree)
    assert {tuple(sorted(cell)) for cell in decoded.simplices.tolist()} == {
        tuple(sorted(cell)) for cell in mesh.simplices.tolist()
    }
    binary = tetraskel.binarize(tree)
    assert np.array_equal(binary.parents(), tree.parent)
    kept_nodes = tetraskel.remove_flat(tree, threshold=float(rng.choice([0.0, 0.01, 0.5, 1.0])))
    assert len(kept_nodes) <= len(tree)
    skeleton = tetraskel.assemble_skeleton(kept_nodes, centre=str(rng.choice(CENTRES)), keep_leaves=rng.random() < 0.5)
    assert np.isfinite(skeleton.points).all()
    assert (skeleton.parent < np.arange(len(skeleton.parent))).all()
    assert np.isfinite(skeleton.branch_lengths).all()
    assert len(tetraskel.tree_skeleton(points).points) > 0 or len(points) == 0


def probe_interior(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    ratio, noise = float(rng.choice([1.0, 1.5, 2.0, 50.0])), float(rng.choice([0.0, 2.0]))
    inside = tetraskel.interior(mesh, ratio=ratio, noise=noise)
    assert inside.shape == (len(mesh),)
    assert inside.dtype == bool
    gates = tetraskel.gate_tree(mesh)
    arrays = tetraskel.gate_arrays(gates, mesh.neighbors)
    for values in vars(arrays).values():
        assert len(values) == len(mesh)
        assert not np.isnan(np.asarray(values, float)).any()
    kept_cells = tetraskel.submesh(mesh, inside)
    assert len(kept_cells) == inside.sum()


def check_skeleton(skeleton: tetraskel.Skeleton, n: int) -> None:
    assert np.isfinite(skeleton.points).all()
    assert np.isfinite(skeleton.radius).all()
    assert (skeleton.radius >= 0).all()
    assert len(skeleton.point_nodes) == n
    assert n == 0 or len(skeleton) > 0, "silently empty"
    assert len(skeleton.edges) - len(skeleton) + skeleton.components == skeleton.loops
    assert (skeleton.parent < 0).sum() == skeleton.components
    for name, values in vars(skeleton).items():
        if name != "branch_tortuosity":
            assert np.isfinite(np.asarray(values, float)).all(), name


def random_model(points: NDArray, rng: Rng) -> CurveModel:
    mesh = random_mesh(points, rng)
    inside = None if rng.random() < 0.3 else labels_of(mesh, rng)
    return tetraskel.curve_model(mesh, inside=inside, loop_spacings=float(rng.choice([0.0, 1.45, 10.0])))


def probe_curve(points: NDArray, rng: Rng) -> None:
    model = random_model(points, rng)
    for root in ("paper", "widest", rng.normal(size=model.inner.mesh.points.shape[1])):
        skeleton = tetraskel.draw_curve(model, detail=float(rng.choice([0.0, 0.5, 1.0])), root=root)
        check_skeleton(skeleton, len(points))
    box = model.inner.mesh.points
    if len(box):
        slack = 1e-6 * np.ptp(box, axis=0).max() + 1e-9 * np.abs(box).max()
        assert (skeleton.points >= box.min(axis=0) - slack).all()
        assert (skeleton.points <= box.max(axis=0) + slack).all()
    sheets = tetraskel.medial_mesh(model, sheet_angle=float(rng.choice([0.0, 120.0, 180.0])))
    assert np.isfinite(sheets.points).all()
    assert np.isfinite(sheets.radius).all()
    assert ((sheets.angle >= 0) & (sheets.angle <= 180)).all()


def probe_curve_of_points(points: NDArray, rng: Rng) -> None:
    check_skeleton(tetraskel.curve_skeleton(points, detail=float(rng.random())), len(points))


def probe_smooth_and_surface(points: NDArray, rng: Rng) -> None:
    skeleton = tetraskel.draw_curve(random_model(points, rng))
    smooth = tetraskel.bezier_skeleton(skeleton, tolerance=float(rng.choice([1e-6, 0.1, 0.9])), samples=4)
    for values in (smooth.control, smooth.control_radius, smooth.curvature, smooth.torsion, smooth.skeleton.points):
        assert np.isfinite(values).all()
    check_surface(skeleton)


def check_surface(skeleton) -> None:
    surface = tetraskel.skeleton_surface(skeleton, cells_per_radius=1, max_cells=1000)
    assert np.isfinite(surface.points).all()
    assert np.isfinite(surface.normals).all()
    edges = surface.simplices
    if surface.simplices.shape[1] == 3:
        edges = np.concatenate([edges[:, [0, 1]], edges[:, [1, 2]], edges[:, [2, 0]]]).astype(np.int64)
        forth, back = (np.sort(a * len(surface) + b) for a, b in (edges.T, edges.T[::-1]))
        assert (forth[1:] != forth[:-1]).all(), "an edge twice in one direction"
        assert np.array_equal(forth, back), "not closed"
    error = tetraskel.surface_error(
        surface, skeleton.points if isinstance(skeleton, tetraskel.Skeleton) else skeleton[0]
    )
    assert all(np.isfinite(value) for value in error.values())


def probe_voronoi(points: NDArray, rng: Rng) -> None:
    is_delaunay = rng.random() < 0.5  # joggled points moved back may not be
    mesh = tetraskel.triangulate(points) if is_delaunay else random_mesh(points, rng)
    labels = labels_of(mesh, rng)
    angle, separation = float(rng.choice([0.0, 60.0, 180.0])), float(rng.choice([0.0, 0.1]))
    for method in VORONOI_METHODS:
        found = tetraskel.voronoi_skeleton(
            mesh, method=method, inside=labels, least_angle=angle, least_separation=separation
        )
        assert np.isfinite(found.points).all()
        assert np.isfinite(found.radius).all()
        if is_delaunay and method != "sk4" and len(found):
            low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
            room = (0.5 if method == "sk2" else 1e-6) * np.linalg.norm(high - low)  # see docs/voronoi.md for sk2
            assert (found.points >= low - room).all()
            assert (found.points <= high + room).all()
        assert ((found.angle >= 0) & (found.angle <= 180 + 1e-9)).all()
        assert len(found.separation) == len(found.vertices) + len(found.lines) + found.n_polygons
        ids = np.concatenate([found.vertices, found.lines.ravel(), found.connectivity])
        assert ((ids >= 0) & (ids < len(found))).all()


def probe_raster(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    mask = tetraskel.rasterise(mesh, inside=labels_of(mesh, rng), resolution=int(rng.choice([2, 3, 20])))
    assert np.isfinite(mask.origin).all()
    assert (mask.spacing > 0).all()
    element = str(rng.choice(ELEMENTS))
    for method in RASTER_METHODS:
        found = tetraskel.raster_skeleton(
            mask.values, method=method, element=element, spacing=mask.spacing, origin=mask.origin
        )
        assert np.isfinite(found.points).all()
        assert mask.values[tuple(found.indices.T)].all()
        assert len(found) > 0
        if method == "morphological":
            assert np.array_equal(tetraskel.morphological_reversal(found), mask.values)


def probe_denoised(points: NDArray, rng: Rng) -> None:
    found = tetraskel.denoised(points)
    assert np.isfinite(found.points).all()
    assert len(found.stands_for) == len(points)
    assert len(found.ids) == len(found.points)
    assert np.isfinite(found.noise)


def probe_thinned(points: NDArray, rng: Rng) -> None:
    most = int(rng.choice([100, 150]))
    found = tetraskel.thinned(points, most_points=most, samples_per_radius=float(rng.choice([1.0, 6.0])))
    assert len(found) <= most
    assert (len(found) > 0) == (len(points) > 0)
    assert (np.diff(found.ids) > 0).all()
    away = np.linalg.norm(np.asarray(points, float)[:, None] - np.asarray(points, float)[None, found.ids], axis=2)
    size = away.max(initial=0)
    room = np.sqrt(points.shape[1]) * found.spacing * (1 + 1e-9) + 1e-9 * size
    assert (away <= room).any(axis=1).all()
    order = rng.permutation(len(points))
    again = tetraskel.thinned(points[order], most_points=most, samples_per_radius=6.0)
    other = tetraskel.thinned(points, most_points=most, samples_per_radius=6.0)
    places = [np.asarray(points, float)[ids] for ids in (order[again.ids], other.ids)]
    assert np.array_equal(*(np.sort(one.view([("", float)] * points.shape[1]), axis=0) for one in places))


def probe_outline(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    if mesh.dim == 2 and rng.random() < 0.7:
        segments = hull_facets(mesh)
    else:
        n = len(mesh.points)
        ring = rng.permutation(n)[: int(rng.integers(2, 6))]
        segments = np.stack([ring, np.roll(ring, -1)], axis=1)
    followed, inside = tetraskel.inside_by_outline(mesh, mesh.points, segments)
    assert inside.shape == (len(followed),)
    assert len(followed.original_ids) == len(followed.points)


def probe_surface_side(points: NDArray, rng: Rng) -> None:
    """The hull, or any triangles, as the surface that tells the inside; and as the surface a skeleton is judged by."""
    mesh = random_mesh(points, rng)
    triangles = hull_facets(mesh)
    if rng.random() < 0.3 and len(mesh.points):
        triangles = rng.integers(0, len(mesh.points), (5, 3))
    inside = tetraskel.interior(mesh, method="surface", surface=(mesh.points, triangles))
    assert inside.shape == (len(mesh),)
    skeleton = tetraskel.draw_curve(tetraskel.curve_model(mesh, inside=np.ones(len(mesh))))
    numbers = tetraskel.measure(skeleton, (mesh.points, triangles))
    assert all(np.isfinite(value) for value in numbers.values())
    assert 0 <= numbers["inside"] <= 1
    assert 0 <= numbers["centredness"] <= 1 + 1e-9


def probe_compare(points: NDArray, rng: Rng) -> None:
    mesh = random_mesh(points, rng)
    methods = [str(name) for name in rng.choice(COMPARED, 2, replace=False)]
    rows = tetraskel.compare(mesh, inside=labels_of(mesh, rng), resolution=12, methods=methods)
    for row in rows:
        assert row.kind or row.failure
        assert ":" not in row.failure.split(" ")[0], f"{row.method} failed: {row.failure}"  # the name of an exception
        for name, value in row.measures.items():
            assert value is None or np.isfinite(value), (row.method, name)


def probe_given_mesh(points: NDArray, rng: Rng) -> None:
    """Simplices made by others, often no mesh at all."""
    n, width = len(points), int(rng.integers(3, 5))
    cells = rng.integers(0, max(n, 1), (int(rng.integers(0, 8)), width))
    if rng.random() < 0.5:
        own = tetraskel.triangulate(points).simplices
        cells = own[rng.random(len(own)) < rng.choice([0.3, 1.0])]
    mesh = tetraskel.triangulation_of(points, cells)
    tree = tetraskel.build_tree(mesh)
    assert len(tree) == len(mesh)
    assert np.isfinite(tetraskel.assemble_skeleton(tree).points).all()
    if len(mesh):
        check_skeleton(tetraskel.curve_skeleton(mesh), n)


def probe_balls(points: NDArray, rng: Rng) -> None:
    """Any graph of balls."""
    n = len(points)
    edges = rng.integers(0, max(n, 1), (int(rng.integers(0, 12)), 2))
    radius = rng.random(n) * rng.choice([0.0, 1e-9, 0.1, 1e3]) * rng.choice([-1.0, 1.0, 1.0, 1.0])
    smooth = tetraskel.bezier_skeleton((points, edges, radius))
    assert np.isfinite(smooth.control).all()
    check_surface((points, edges, radius))


PROBES: dict[str, Callable[[NDArray, Rng], None]] = {
    name.removeprefix("probe_"): made for name, made in list(globals().items()) if name.startswith("probe_")
}
