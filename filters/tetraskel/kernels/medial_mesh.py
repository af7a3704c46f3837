"""The medial sheets as triangles: for plates, which no curve describes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, part, silent
from tetraskel.kernels.curve import CurveModel
from tetraskel.kernels.dual_complex import DualComplex, dual_complex, facets_of
from tetraskel.kernels.medial_nodes import MedialNodes
from tetraskel.kernels.pieces import label_pieces
from tetraskel.options import CurveOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class MedialMesh:
    """Triangles of the medial sheets, a fan per face of the Voronoi diagram.

    Attributes
    ----------
    points : (p, e) float
        Corners of the faces in ascending order of their coordinates, then one centre per face.
    triangles : (t, 3) int
        Two corners of a face and its centre. The normal of a face points where its largest component is positive.
    radius : (p,) float
        Of the ball around each point: distance to the nearest input points at a corner, the mean of its corners' at a
        centre.
    angle : (t,) float
        Object angle of the face, in degrees, 0 to 180.
    """

    points: Floats
    triangles: Ints
    radius: Floats
    angle: Floats

    def __len__(self) -> int:
        return len(self.triangles)

    @property
    def areas(self) -> Floats:
        """(t,) area of each triangle."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return 0.5 * np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1))


def medial_mesh(model: CurveModel, *, sheet_angle: float = CurveOptions.sheet_angle, tick: Tick = silent) -> MedialMesh:
    """Interior faces of the Voronoi diagram whose two surface points are seen far enough apart.

    A face lies midway between the two ends of a mesh edge whose ring of tetrahedra closes inside. Its object angle
    is that between the ways to the two ends from a place as far from them as its corners are on average (the measure
    by which Foskey, Lin and Manocha 2003 simplify medial axes). Near 180 degrees the ends lie on sides that face each
    other; faces between neighbouring samples, which reach from a sheet to the surface, are seen under small angles.
    Samples are not opposite to one another: angles are off by about the ratio of their spacing to the radius.

    Faces with a corner that is no circumcentre inside are left out, and so are pieces of sheet with less area than
    the great disc of their widest ball: crumbs, and the ribbons along the axes of tubes. An angle of 0 gives all faces,
    these too. In the plane the medial axis is made of curves: there are no sheets.

    Parameters
    ----------
    model : CurveModel
        From `curve_model`.
    sheet_angle : float
        Least object angle, in degrees; see `CurveOptions`.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    MedialMesh
        Faces in the order of their mesh edges, which depends on coordinates only.

    Raises
    ------
    InputError
        For an angle out of bounds.

    Examples
    --------
    >>> import numpy as np
    >>> from tetraskel import curve_model, triangulate
    >>> ways = np.random.default_rng(0).normal(size=(2000, 3))
    >>> lens = ways / np.linalg.norm(ways, axis=1, keepdims=True) * [1, 1, 0.3]
    >>> sheet = medial_mesh(curve_model(triangulate(lens)))
    >>> bool(np.abs(sheet.points[:, 2]).max() < 0.03)
    True
    """
    CurveOptions(sheet_angle=sheet_angle)
    inner, nodes = model.inner, model.nodes
    if inner.simplices.shape[1] < 4 or len(inner.simplices) == 0:
        return _no_sheets(inner.mesh.points.shape[1])
    facets = facets_of(inner.simplices, inner.neighbors, part(tick, 0.0, 0.1))
    cells = dual_complex(inner.simplices, facets, len(inner.coordinates), part(tick, 0.1, 0.5))
    across = inner.coordinates[cells.ridge_points[:, 1]] - inner.coordinates[cells.ridge_points[:, 0]]
    angle = _object_angles(cells, nodes, across)
    tick(0.6)
    sheet = _fans(cells, nodes, np.flatnonzero(angle >= sheet_angle), across, angle, tick)
    tick(0.8)
    if sheet_angle > 0:
        sheet = _without_crumbs(sheet, tick)
    tick(1.0)
    return sheet


def _no_sheets(dim: int) -> MedialMesh:
    return MedialMesh(np.empty((0, dim)), np.empty((0, 3), np.int64), np.empty(0), np.empty(0))


def _object_angles(cells: DualComplex, nodes: MedialNodes, across: Floats) -> Floats:
    """(faces,) angle between the ends of `across` seen from a face, in degrees; nan where it lacks a corner.

    At a distance R of both ends, sin(angle / 2) is half the distance between them over R.
    """
    sizes = np.diff(cells.ring_start)
    sides = cells.facets[cells.ring_facets]  # every corner of a face ends two of its sides
    face = np.repeat(np.arange(len(sizes)), sizes)
    radius = _means(nodes.radii[sides].mean(axis=1)[:, None], face, len(sizes))[:, 0]
    whole = np.bincount(face, nodes.is_medial[sides].all(axis=1), minlength=len(sizes)) == sizes
    half = np.sqrt((across**2).sum(axis=1)) / 2
    return np.where(whole, 2 * np.degrees(np.arcsin(np.minimum(half / radius, 1))), np.nan)


def _fans(cells: DualComplex, nodes: MedialNodes, faces: Ints, across: Floats, angle: Floats, tick: Tick) -> MedialMesh:
    """Triangles from each edge of the faces to the face's centre."""
    sizes = np.diff(cells.ring_start)[faces]
    fan = np.repeat(np.arange(len(faces)), sizes)
    row = np.arange(len(fan)) + np.repeat(cells.ring_start[:-1][faces] - (np.cumsum(sizes) - sizes), sizes)
    sides = cells.facets[cells.ring_facets[row]]
    # simplices on one sphere share their centre, and a side between two of them has no length
    positions, radii, number = _distinct(nodes, sides)
    tick(0.65)
    sides = number[sides]
    long = sides[:, 0] != sides[:, 1]
    fan, sides = fan[long], sides[long]
    centres = _means(positions[sides].mean(axis=1), fan, len(faces))
    tick(0.7)
    centre_radii = _means(radii[sides].mean(axis=1)[:, None], fan, len(faces))[:, 0]
    points = np.concatenate([positions, centres])
    tick(0.75)
    triangles = np.column_stack([sides, len(positions) + fan])
    triangles = _turned(points, triangles, across[faces[fan]], part(tick, 0.75, 0.8))
    return MedialMesh(points, triangles, np.concatenate([radii, centre_radii]), angle[faces[fan]])


def _distinct(nodes: MedialNodes, wanted: Ints) -> tuple[Floats, Floats, Ints]:
    """Positions of the wanted nodes, ascending and each once, their radii, and which of them each node has."""
    is_wanted = np.zeros(len(nodes.positions), bool)
    is_wanted[wanted] = True
    used = np.flatnonzero(is_wanted)
    used = used[np.lexsort(nodes.positions[used].T[::-1])]
    positions = nodes.positions[used]
    is_new = np.ones(len(used), bool)
    is_new[1:] = (positions[1:] != positions[:-1]).any(axis=1)
    number = np.full(len(nodes.positions), -1)
    number[used] = np.cumsum(is_new) - 1
    return positions[is_new], nodes.radii[used[is_new]], number


def _means(values: Floats, group: Ints, n: int) -> Floats:
    """(n, k) means of the (s, k) values of each group."""
    count = np.maximum(np.bincount(group, minlength=n), 1)
    return np.stack([np.bincount(group, column, minlength=n) / count for column in values.T], axis=1)


def _turned(points: Floats, triangles: Ints, across: Floats, tick: Tick) -> Ints:
    """Triangles whose normals point along `across`, taken in the sense that makes its largest component positive."""
    turned = triangles.copy()

    def work(piece: slice) -> None:
        ways = across[piece]
        sense = np.sign(ways[np.arange(len(ways)), np.abs(ways).argmax(axis=1)])
        a, b, c = points[triangles[piece]].transpose(1, 0, 2)
        wrong = (np.cross(b - a, c - a) * ways).sum(axis=1) * sense < 0
        turned[piece][wrong, :2] = triangles[piece][wrong, 1::-1]

    for_chunks(work, len(triangles), tick)
    return turned


def _without_crumbs(sheet: MedialMesh, tick: Tick) -> MedialMesh:
    """The pieces, joined across sides of faces, that are at least as large as their widest ball's great disc."""
    before = _triangles_before(sheet.triangles)
    tick(0.85)
    piece = label_pieces(before)
    tick(0.95)
    n = int(piece.max(initial=-1)) + 1
    area, radius = np.bincount(piece, sheet.areas, minlength=n), np.zeros(n)
    np.maximum.at(radius, piece, sheet.radius[sheet.triangles].max(axis=1))
    kept = (area >= np.pi * radius**2)[piece]
    is_used = np.zeros(len(sheet.points), bool)
    is_used[sheet.triangles[kept]] = True
    number = np.cumsum(is_used) - 1
    return MedialMesh(sheet.points[is_used], number[sheet.triangles[kept]], sheet.radius[is_used], sheet.angle[kept])


def _triangles_before(triangles: Ints) -> Ints:
    """(t, 2) for each triangle the one before it in its fan and the one before it at its outer side, or -1."""
    before = np.full((len(triangles), 2), -1)
    same_fan = np.flatnonzero(triangles[1:, 2] == triangles[:-1, 2]) + 1
    before[same_fan, 0] = same_fan - 1
    low, high = np.sort(triangles[:, :2], axis=1).astype(np.int64).T
    sides = low << 32 | high
    order = np.argsort(sides, kind="stable")
    same_side = np.flatnonzero(np.diff(sides[order]) == 0)
    before[order[same_side + 1], 1] = order[same_side]
    return before
