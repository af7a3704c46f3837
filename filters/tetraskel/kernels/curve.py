"""Points to curve skeleton: the stages in order, and what is kept so that another detail is drawn at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import NoInsideError, TetraskelError
from tetraskel.kernels.attachment import anchor_points, points_of_anchors
from tetraskel.kernels.branches import Branches, grow_branches
from tetraskel.kernels.burning import begin_burning
from tetraskel.kernels.chains import merge_close_junctions, trace_chains
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.collapse import Collapse, collapse_to_graph
from tetraskel.kernels.core import Core, loop_core
from tetraskel.kernels.curve_arrays import assemble
from tetraskel.kernels.curve_lines import Lines, smooth_lines
from tetraskel.kernels.curve_roots import first_facets, first_of_each, in_mesh
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.curve_stages import begin_stage
from tetraskel.kernels.dual_complex import DualComplex, dual_complex, facets_of
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.inner_mesh import InnerMesh, inner_mesh
from tetraskel.kernels.interior import inside_of_object
from tetraskel.kernels.loops import Loops, find_loops
from tetraskel.kernels.medial_nodes import MedialNodes, facing, medial_nodes
from tetraskel.kernels.medial_tree import medial_tree
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.passage_widths import widths_of_facets
from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import CurveOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

NEAREST = 6  # points whose mean distance is the local spacing
FACING_POWER = 2  # how much paths prefer places midway between two sides of the object
# detail -> least significance drawn; logarithms are interpolated in between
DETAILS = (0.0, 0.5, 1.0)
SIGNIFICANCES = (0.2, 0.072, 0.02)


@dataclass(frozen=True)
class CurveModel:
    """All that does not depend on the detail.

    Attributes
    ----------
    inner : InnerMesh
    nodes : MedialNodes
    core : Core
        With the medial tree.
    branches : Branches
    loops : Loops
    cavities : int
    anchors : (n,) int
        For each point of the mesh the node of the finest skeleton on the way from its widest simplex to the root.
    """

    inner: InnerMesh
    nodes: MedialNodes
    core: Core
    branches: Branches
    loops: Loops
    cavities: int
    anchors: Ints

    @cached_property
    def first_facets(self) -> Floats:
        """(c, d) barycentre of the boundary facet of each component that comes first by its coordinates."""
        return first_facets(self.inner, self.core.tree)


def curve_skeleton(
    points_or_mesh: ArrayLike | Triangulation,
    *,
    detail: float = CurveOptions.detail,
    loop_spacings: float = CurveOptions.loop_spacings,
    denoise: bool = CurveOptions.denoise,
    inside: ArrayLike | None = None,
    root: str | ArrayLike = CurveOptions.root,
    tick: Tick = silent,
) -> Skeleton:
    """The curve skeleton of a cloud of surface points, or of a mesh with an inside.

    Parameters
    ----------
    points_or_mesh : (n, 2) or (n, 3) array, or Triangulation
        Points are triangulated and the inside is found by gates; so it is for the result of `triangulate`. A
        triangulation made by others (`triangulation_of`) is all inside.
    detail : float
        From 0, the main lines, to 1; see `CurveOptions`.
    loop_spacings, denoise
        See `CurveOptions`.
    inside : (m,) array, optional
        Simplices of the mesh that lie inside: those that are not 0.
    root : {"paper", "widest"} or (d,) array
        See `CurveOptions`; a place roots each piece at its node nearest to it.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    Skeleton
        One connected piece per piece of the inside. No points give an empty skeleton.

    Raises
    ------
    InputError
        For options out of bounds, points that are not finite, too few or on one line, or when nothing is inside.

    Examples
    --------
    >>> import numpy as np
    >>> angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    >>> circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    >>> ring = curve_skeleton(np.concatenate([circle, 0.6 * circle]))
    >>> ring.components, ring.loops, ring.n_branches
    (1, 1, 1)
    """
    check_curve_options(detail, loop_spacings, root)
    if isinstance(points_or_mesh, Triangulation):
        mesh, share = points_or_mesh, 0.0
    else:
        share = 0.5
        mesh = triangulate(points_or_mesh, denoise=denoise, tick=part(tick, 0.0, share))
    model = curve_model(mesh, inside=inside, loop_spacings=loop_spacings, tick=part(tick, share, 0.97))
    return draw_curve(model, detail=detail, root=root, tick=part(tick, 0.97, 1.0))


def check_curve_options(detail: float, loop_spacings: float, root: str | ArrayLike) -> None:
    """Raise `InputError` for a value that `CurveOptions` does not allow."""
    CurveOptions(detail=detail, loop_spacings=loop_spacings, root=root if isinstance(root, str) else "point")


def curve_model(
    mesh: Triangulation,
    *,
    inside: ArrayLike | None = None,
    loop_spacings: float = CurveOptions.loop_spacings,
    tick: Tick = silent,
) -> CurveModel:
    """Everything up to the choice of the detail; see `curve_skeleton`.

    Raises
    ------
    InputError
        When nothing is inside.
    """
    expect_mesh(mesh)
    expect_extent(mesh.points)
    telling = "Telling inside from outside"
    labels = inside_of_object(mesh, inside, begin_stage(tick, telling, 0.0, 0.9))
    inner = inner_mesh(mesh, labels, begin_stage(tick, telling, 0.9, 1.0))
    if len(inner.simplices) == 0 and len(mesh.points):
        raise NoInsideError(
            f"expected an object with an inside, got none in {len(mesh.points)} points: they may fill a volume, lie on "
            "an open surface, or be too sparse; label the inside yourself, or take the whole mesh as inside."
        )
    placing = begin_stage(tick, "Placing the nodes")
    nodes = medial_nodes(inner.coordinates, inner.simplices, inner.neighbors, placing)
    facets = facets_of(inner.simplices, inner.neighbors, begin_stage(tick, "Joining the nodes", 0.0, 0.2))
    joining = begin_stage(tick, "Joining the nodes", 0.2, 0.9)
    cells = dual_complex(inner.simplices, facets, len(inner.coordinates), joining)
    burning = begin_burning(cells, nodes.positions, nodes.radii)  # nothing before needs it
    widths = widths_of_facets(inner.coordinates, facets.points, begin_stage(tick, "Joining the nodes", 0.9, 1.0))
    collapse = collapse_to_graph(cells, widths, begin_stage(tick, "Collapsing to a graph"))
    check_homotopy(cells, collapse)
    loops = find_loops(
        cells,
        collapse,
        widths,
        lambda facets: _spacing(inner, cells, facets),
        loop_spacings=loop_spacings,
        tick=begin_stage(tick, "Finding the loops"),
    )
    burn = burning(begin_stage(tick, "Burning from the surface"))
    burn = np.where(nodes.is_medial, burn, nodes.radii)
    growing = begin_stage(tick, "Growing the tree", 0.0, 0.8)
    strength = np.sqrt(burn * nodes.radii) * facing(inner.coordinates, inner.simplices, nodes) ** FACING_POWER
    tree = medial_tree(cells, nodes.positions, strength, loops.cut, growing)
    core = loop_core(tree, cells, loops.crossings, loops.cut, begin_stage(tick, "Growing the tree", 0.8, 1.0))
    branching = begin_stage(tick, "Growing the branches", 0.0, 0.8)
    branches = grow_branches(core, nodes.positions, nodes.radii, burn, branching)
    attaching = begin_stage(tick, "Growing the branches", 0.8, 1.0)
    anchors = anchor_points(inner, nodes, core, branches, attaching)
    return CurveModel(inner, nodes, core, branches, loops, collapse.n_punctures, anchors)


def _spacing(inner: InnerMesh, cells: DualComplex, facets: Ints) -> Floats:
    """Mean distance from the points of each facet's first simplex to their six nearest."""
    if len(facets) == 0:
        return np.empty(0)
    corners = inner.simplices[cells.facets[facets, 0]]
    cloud = Cloud(inner.mesh.coordinates)
    away, _ = cloud.query(inner.coordinates[corners.ravel()], min(NEAREST + 1, cloud.n))
    return away[:, 1:].mean(axis=1).reshape(corners.shape).mean(axis=1)


def check_homotopy(cells: DualComplex, collapse: Collapse) -> None:
    """Raise `TetraskelError` unless the graph has the Euler characteristic of the complex it was collapsed from."""
    of_graph = cells.n_nodes - int(collapse.kept.sum())
    expected = cells.euler_characteristic - collapse.n_punctures
    if of_graph != expected:
        raise TetraskelError(
            f"the graph has Euler characteristic {of_graph}, the interior {expected}: the collapse went wrong; "
            "please report this with the input."
        )


def least_significance(detail: float) -> float:
    """Significance below which nothing is drawn at this detail."""
    return float(np.exp(np.interp(detail, DETAILS, np.log(SIGNIFICANCES))))


def draw_curve(
    model: CurveModel,
    *,
    detail: float = CurveOptions.detail,
    root: str | ArrayLike = CurveOptions.root,
    tick: Tick = silent,
) -> Skeleton:
    """The skeleton at one detail, from a model: quick, for a slider. `tick` is told the share of work done.

    Raises
    ------
    InputError
        For options out of bounds.
    """
    check_curve_options(detail, 0.0, root)
    tree, nodes = model.core.tree, model.nodes
    drawn = model.branches.edges[: model.branches.count(least_significance(detail))]
    edges = np.concatenate([model.core.edges, *drawn])
    graph_nodes = np.unique(np.concatenate([model.core.nodes, edges.ravel()]))
    chains = merge_close_junctions(trace_chains(graph_nodes, edges), nodes.positions, nodes.radii)
    tick(0.1)
    lines = smooth_lines(chains, nodes, model.inner, part(tick, 0.1, 0.7))
    component = tree.component[lines.nodes]
    root_points = _root_points(model, lines, component, root)
    tick(0.8)
    skeleton, number = assemble(lines, component, root_points, _radii(model, lines))
    tick(0.9)
    skeleton = replace(
        skeleton,
        points=lifted(skeleton.points, model.inner.mesh),
        point_nodes=_point_nodes(model, lines, number),
        components=len(tree.roots),
        loops=len(model.loops.closing),
        loops_refused=len(model.loops.refused),
        cavities=model.cavities,
    )
    check_loops(skeleton)
    tick(1.0)
    return skeleton


def _point_nodes(model: CurveModel, lines: Lines, number: Ints) -> Ints:
    """Skeleton point of every input point."""
    found = points_of_anchors(model.anchors, model.core.tree, model.nodes.positions, lines)
    mesh = model.inner.mesh
    ids = mesh.point_map if len(mesh.point_map) else np.arange(len(mesh.points))
    return number[found][ids] if len(number) else np.full(len(ids), -1)


def check_loops(skeleton: Skeleton) -> None:
    """Raise `TetraskelError` unless the drawn graph has as many loops and pieces as were found."""
    drawn = len(skeleton.edges) - len(skeleton.points) + skeleton.components
    if drawn != skeleton.loops:
        raise TetraskelError(f"drew {drawn} loops of {skeleton.loops}; please report this with the input.")


def _radii(model: CurveModel, lines: Lines) -> Floats:
    """Distance to the nearest point of the object."""
    if len(lines.positions) == 0:
        return np.empty(0)
    return np.asarray(model.inner.cloud.query(lines.positions)[0])


def _root_points(model: CurveModel, lines: Lines, component: Ints, root: str | ArrayLike) -> Ints:
    """Point of the lines at which each component is rooted."""
    if isinstance(root, str) and root == "widest":
        return first_of_each(component, -model.nodes.radii[lines.nodes])
    places = model.first_facets[component] if isinstance(root, str) else in_mesh(root, model.inner.mesh)
    return first_of_each(component, ((lines.positions - places) ** 2).sum(axis=1))


def lifted(positions: Floats, mesh: Triangulation) -> Floats:
    """Positions in the mesh's coordinates, in the space of its points."""
    return positions if mesh.plane is None else mesh.plane.lift(positions)
