"""The measures of a curve skeleton for anything drawn, as far as they make sense for it, in space and in the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.ball_graph import BallGraph, ball_graph, branches_of
from tetraskel.kernels.drawn import LINES, POINTS, SHEETS, Drawn
from tetraskel.kernels.measures import SAMPLES, SURFACE_SAMPLES, balls_along, count_components, samples_along
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.object_boundary import Boundary

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

Numbers = dict[str, float | None]

PLACES = 1000  # looked at where lines have more edges than that, on sheets and among points: shares to 0.03
NEIGHBORS = (1, 8, 64)  # nearest centres of a class looked at before all are
CLASS_STEP = 1.1  # between the largest radii of one class of balls and of the next
N_CLASSES = 40
MEASURES = (
    "points", "components", "loops", "euler", "ends", "junctions", "branches", "length", "area", "inside",
    "centredness", "reconstruction_mean", "reconstruction_max", "short_branches",
)  # fmt: skip


def judge(drawn: Drawn, coordinates: Floats, boundary: Boundary) -> Numbers:
    """Every one of `MEASURES`, None where it has no meaning for what is drawn.

    Parameters
    ----------
    drawn : Drawn
    coordinates : (p, d) float
        Of its points, in the coordinates of the boundary.
    boundary : Boundary

    Notes
    -----
    As in `tetraskel.kernels.measures.measure`, with shares and means over the length of lines, over the area of
    sheets, and over the points where there are points only. `euler` is points less edges plus polygons.
    """
    numbers: Numbers = dict.fromkeys(MEASURES)
    numbers["points"] = len(drawn)
    graph = ball_graph((coordinates, drawn.edges, drawn.radius))
    numbers |= _counts(drawn, coordinates, graph)
    places, weights = _samples(drawn, coordinates, graph)
    if len(places) == 0:
        return numbers
    inside = boundary.contains(places)
    weights = weights if weights.any() else np.ones(len(weights))  # everything in one place
    total = float(weights.sum())
    numbers["inside"] = min(max(float((weights * inside).sum()) / total, 0.0), 1.0)
    kept = weights[inside]
    if kept.any():
        values = boundary.centredness(places[inside])
        numbers["centredness"] = float((kept * values).sum() / kept.sum())
    centres, radii = balls_along(graph)
    distance = distances_to_union(centres, radii, boundary.samples(SURFACE_SAMPLES))
    numbers["reconstruction_mean"] = 100 / boundary.diagonal * float(distance.mean())
    numbers["reconstruction_max"] = 100 / boundary.diagonal * float(distance.max())
    return numbers


def _counts(drawn: Drawn, coordinates: Floats, graph: BallGraph) -> Numbers:
    if drawn.kind == POINTS:
        return {}
    edges, n = drawn.all_edges, len(drawn)
    components = count_components(edges, n)
    counts: Numbers = {"components": components, "euler": n - len(edges) + len(drawn.offsets) - 1}
    if drawn.kind == SHEETS:
        return counts | {"area": float(_fans(drawn, coordinates)[1].sum())}
    graph = branches_of(graph)
    lengths = _chain_lengths(graph)
    return counts | {
        "loops": len(edges) - n + components,
        "ends": int((graph.degree == 1).sum()),
        "junctions": int((graph.degree > 2).sum()),
        "branches": len(lengths),
        "length": float(lengths.sum()),
        "short_branches": _short_share(graph, lengths),
    }


def _chain_lengths(graph: BallGraph) -> Floats:
    path = graph.points[graph.connectivity]
    steps = np.sqrt((np.diff(path, axis=0, append=path[-1:]) ** 2).sum(axis=1)) if len(path) else np.empty(0)
    steps[graph.offsets[1:] - 1] = 0.0  # from the end of one branch to the beginning of the next
    return np.add.reduceat(steps, graph.offsets[:-1]) if len(path) else np.empty(0)


def _short_share(graph: BallGraph, lengths: Floats) -> float:
    """Share of the length in end branches shorter than the radius where they begin."""
    if lengths.sum() == 0:
        return 0.0
    tips = np.stack([graph.connectivity[graph.offsets[:-1]], graph.connectivity[graph.offsets[1:] - 1]], axis=1)
    degrees = graph.degree[tips]
    inner = np.where(degrees[:, 0] > 2, tips[:, 0], tips[:, 1])
    hangs = (degrees.min(axis=1) == 1) & (degrees.max(axis=1) > 2)
    return float(lengths[hangs & (lengths < graph.radius[inner])].sum() / lengths.sum())


def _samples(drawn: Drawn, coordinates: Floats, graph: BallGraph) -> tuple[Floats, Floats]:
    """Places on what is drawn, and what each stands for: a length, an area, or a point."""
    if drawn.kind == SHEETS:
        return _on_sheets(*_fans(drawn, coordinates))
    if drawn.kind == LINES and len(graph.edges) <= PLACES:
        return samples_along(graph, SAMPLES)
    if drawn.kind == LINES:
        return _on_many_lines(*coordinates[graph.edges.T])
    chosen = np.arange(len(drawn)) if len(drawn) <= PLACES else np.linspace(0, len(drawn) - 1, PLACES).astype(int)
    return coordinates[chosen], np.ones(len(chosen))


def _on_many_lines(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Places at equal steps of the length of all lines together: most lines have none."""
    until = np.cumsum(np.sqrt(((b - a) ** 2).sum(axis=1)))
    at = (np.arange(PLACES) + 0.5) / PLACES * until[-1]
    line = np.searchsorted(until, at)
    share = ((until[line] - at) / np.diff(until, prepend=0.0)[line])[:, None]
    return share * a[line] + (1 - share) * b[line], np.ones(PLACES)


def _fans(drawn: Drawn, coordinates: Floats) -> tuple[Floats, Floats]:
    """Triangles (t, 3, 3) from the first corner of each polygon to its sides, and their areas.

    Where a polygon is not convex some are turned over and cover too much; their areas are negative and take it back.
    """
    first = np.repeat(drawn.connectivity[drawn.offsets[:-1]], np.diff(drawn.offsets))
    corners = coordinates[np.column_stack([first, drawn.sides])]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    whole = np.repeat(np.add.reduceat(normals, drawn.offsets[:-1], axis=0), np.diff(drawn.offsets), axis=0)
    area = np.sqrt((normals**2).sum(axis=1)) * np.sign((normals * whole).sum(axis=1))
    return corners, area


def _on_sheets(corners: Floats, area: Floats) -> tuple[Floats, Floats]:
    """Places spread over triangles, each for an equal area, less than 0 on those that take area back."""
    generator = np.random.default_rng(13)
    until = np.cumsum(np.abs(area))
    if until[-1] == 0:  # sheets so narrow that rounding took their area
        return corners.mean(axis=1), np.ones(len(corners))
    chosen = np.searchsorted(until, (np.arange(PLACES) + 0.5) / PLACES * until[-1])
    s, t = np.sqrt(generator.random(PLACES))[:, None], generator.random(PLACES)[:, None]
    a, b, c = corners[chosen].transpose(1, 0, 2)
    return (1 - s) * a + s * (1 - t) * b + s * t * c, np.sign(area[chosen])


def distances_to_union(centres: Floats, radii: Floats, places: Floats) -> Floats:
    """(k,) distance from each place to a union of balls, 0 inside it.

    Strategy: balls of about one size are asked together for their nearest centres; a ball farther down that list
    cannot be nearer than its distance less the largest radius of the class, and where that is not enough, more are
    asked for.
    """
    found = np.full(len(places), np.inf)
    largest = max(float(radii.max()), 1e-300)
    number = np.minimum(np.log(largest / np.maximum(radii, 1e-300)) / np.log(CLASS_STEP), N_CLASSES - 1).astype(int)
    for some in (np.flatnonzero(number == k) for k in np.unique(number)):
        cloud, farthest, unsure = Cloud(centres[some]), radii[some].max(), np.arange(len(places))
        for k in [n for n in NEIGHBORS if n < len(some)] + [len(some)]:
            unsure = unsure[found[unsure] > 0]
            if len(unsure) == 0:
                break
            step, left = max((1 << 22) // k, 1), []
            for start in range(0, len(unsure), step):
                rows = unsure[start : start + step]
                away, which = (part.reshape(len(rows), k) for part in cloud.query(places[rows], k))
                found[rows] = np.minimum(found[rows], (away - radii[some][which]).min(axis=1))
                left.append(rows[away[:, -1] - farthest < found[rows]])
            unsure = np.concatenate(left)
    return np.maximum(found, 0.0)
