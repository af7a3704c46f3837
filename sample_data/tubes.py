"""Surface samples of tubes: random points, without normals, on what a ball sweeps along a known axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from answers import Answers, Floats, Ints, Sample, listed, rounded

ON_SURFACE = 1e-9  # a sample this much of a radius below another tube's surface still counts as on it


@dataclass(frozen=True)
class Tubes:
    """The union of balls swept along straight edges.

    Attributes
    ----------
    nodes : (n, 3) float
        Points where edges end or meet.
    edges : (m, 2) int
        Pairs of nodes.
    radii : (m,) float
        Radius of the ball on each edge.
    """

    nodes: Floats
    edges: Ints
    radii: Floats

    @property
    def starts(self) -> Floats:
        """(m, 3) first point of each edge."""
        return self.nodes[self.edges[:, 0]]

    @property
    def spans(self) -> Floats:
        """(m, 3) vector from the first to the second point of each edge."""
        return self.nodes[self.edges[:, 1]] - self.starts

    @property
    def lengths(self) -> Floats:
        """(m,) length of each edge."""
        return np.linalg.norm(self.spans, axis=1)


def y_tube() -> Sample:
    """Y of three tubes of one radius in the plane z = 0: a stem and two arms at right angles to each other."""
    nodes = np.array([[0, 0, 0], [0, -2, 0], [1.2, 1.2, 0], [-1.2, 1.2, 0]])
    tubes = Tubes(nodes, np.array([[0, 1], [0, 2], [0, 3]]), np.full(3, 0.3))
    return surface_samples(tubes, 6000, seed=6), tubes_answers(tubes)


def tree_of_tubes() -> Sample:
    """Tree of tubes: a trunk with a side branch and a fork, and a fork at the end of each of the three branches."""
    trunk = [[0, 0, 0], [0, 0, 1.1], [0, 0, 2]]
    branches = [[1, 0.2, 1.7], [-0.8, 0.5, 2.8], [0.2, -0.9, 2.8]]
    twigs = [[1.8, 0.7, 1.9], [1.7, -0.3, 2.3], [-1.5, 0.3, 3.4], [-0.7, 1.2, 3.4], [0.9, -1.1, 3.4], [-0.2, -1.6, 3.3]]
    edges = [[0, 1], [1, 2], [1, 3], [2, 4], [2, 5], [3, 6], [3, 7], [4, 8], [4, 9], [5, 10], [5, 11]]
    tubes = Tubes(np.array(trunk + branches + twigs), np.array(edges), np.repeat([0.3, 0.2, 0.12], [2, 3, 6]))
    return surface_samples(tubes, 12000, seed=12), tubes_answers(tubes)


def limbs() -> Sample:
    """Body along the x axis with twelve limbs across it, from longer and thicker to shorter and thinner ones."""
    places = np.array([0, 0.5, 1.1, 1.6, 2, 2.7, 3.2])  # of the nodes along the body
    roots = [1, 1, 3, 5, 5, 4, 2, 4, 5, 3, 2, 3]
    across = [[0, 1.6], [0, -1.5], [1.1, 0], [-1, 0], [0, 0.8], [0, -0.75], [-0.6, 0], [0, 0.58], [0.55, 0], [-0.53, 0],
              [0, 0.5], [0, 0.48]]  # fmt: skip
    thick = [0.22, 0.2, 0.2, 0.2, 0.16, 0.16, 0.16, 0.16, 0.15, 0.15, 0.15, 0.15]
    body = np.c_[places, np.zeros((len(places), 2))]
    tips = np.c_[places[roots], across]
    along = np.c_[np.arange(6), np.arange(1, 7)]
    edges = np.r_[along, np.c_[roots, np.arange(7, 19)]]
    tubes = Tubes(np.r_[body, tips], edges, np.r_[np.full(6, 0.4), thick])
    return surface_samples(tubes, 5000, seed=7), tubes_answers(tubes)


def surface_samples(tubes: Tubes, n_points: int, *, seed: int) -> Floats:
    """Random points (n, 3), uniform by area on the surface of the union.

    Points are drawn on the sides of all edges and the balls at their ends, in proportion to area; those inside
    another part are dropped.
    """
    rng = np.random.default_rng(seed)
    drawn = points_on_parts(rng, tubes, 3 * n_points)
    exposed = (gaps(drawn, tubes) >= -ON_SURFACE * tubes.radii).all(axis=1)
    if exposed.sum() < n_points:
        raise ValueError(f"expected {n_points} exposed points, got {exposed.sum()}; draw more")
    return drawn[exposed][:n_points]


def points_on_parts(rng: np.random.Generator, tubes: Tubes, count: int) -> Floats:
    """Random points (count, 3) on the sides and the end balls of the edges, some inside other parts."""
    n_edges = len(tubes.edges)
    ends = np.unique(np.c_[tubes.edges.ravel(), np.repeat(tubes.radii, 2)], axis=0)  # one ball per node and radius
    centres, ball_radii = tubes.nodes[ends[:, 0].astype(int)], ends[:, 1]
    areas = np.r_[2 * np.pi * tubes.radii * tubes.lengths, 4 * np.pi * ball_radii**2]
    part = rng.choice(len(areas), size=count, p=areas / areas.sum())
    edge, ball = part[part < n_edges], part[part >= n_edges] - n_edges
    points = np.empty((count, 3))
    points[part < n_edges] = points_on_sides(rng, tubes, edge)
    points[part >= n_edges] = centres[ball] + ball_radii[ball, None] * directions(rng, len(ball))
    return points


def points_on_sides(rng: np.random.Generator, tubes: Tubes, edge: Ints) -> Floats:
    """One random point (k, 3) on the cylinder around each of the given edges (k,)."""
    span = tubes.spans[edge]
    sideways = directions(rng, len(edge))
    sideways -= span * (dot(sideways, span) / dot(span, span))[:, None]
    sideways *= (tubes.radii[edge] / np.linalg.norm(sideways, axis=1))[:, None]
    return tubes.starts[edge] + rng.random((len(edge), 1)) * span + sideways


def gaps(points: Floats, tubes: Tubes) -> Floats:
    """Distance (k, m) from points (k, 3) to the surface of each tube, negative inside."""
    spans = tubes.spans
    offsets = points[:, None] - tubes.starts  # (k, m, 3)
    along = np.clip(dot(offsets, spans) / dot(spans, spans), 0, 1)
    return np.linalg.norm(offsets - along[..., None] * spans, axis=2) - tubes.radii


def directions(rng: np.random.Generator, count: int) -> Floats:
    """Random unit vectors (count, 3), uniform on the sphere."""
    vectors = rng.normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products (...) of vectors (..., 3)."""
    return np.einsum("...i,...i->...", a, b)


def tubes_answers(tubes: Tubes) -> Answers:
    """Axis of the tubes: one polyline per edge; ends and junctions are the nodes of degree 1 and of 3 or more."""
    degree = np.bincount(tubes.edges.ravel())
    ends, junctions = tubes.nodes[degree == 1], tubes.nodes[degree > 2]
    n_loops = len(tubes.edges) - len(tubes.nodes) + 1
    return axis_answers(tubes.nodes[tubes.edges], tubes.radii, ends, junctions, n_loops)


def axis_answers(
    axis: ArrayLike, radii: ArrayLike, ends: ArrayLike = (), junctions: ArrayLike = (), n_loops: int = 0
) -> Answers:
    """What is known of one connected object swept along an axis of polylines (m, k, 3), each with its radius."""
    steps = np.linalg.norm(np.diff(axis, axis=1), axis=2)
    return {
        "dimension": 3,
        "components": 1,
        "loops": n_loops,
        "n_ends": len(ends),
        "n_junctions": len(junctions),
        "ends": listed(ends),
        "junctions": listed(junctions),
        "radii": listed(radii),
        "length": rounded(steps.sum()),
        "axis": listed(axis),
    }


def torus(major: float = 1.0, minor: float = 0.35) -> Sample:
    """Torus around the z axis: a ball of radius `minor` swept along the circle of radius `major` in z = 0."""
    points = points_on_arc_tube(np.random.default_rng(5), 5000, major, minor, turn=2 * np.pi)
    axis = arc(major, np.linspace(0, 2 * np.pi, 73))
    axis[-1] = axis[0]
    circle = {"major_radius": major, "minor_radius": minor, "length": rounded(2 * np.pi * major)}
    content = {"area": rounded(4 * np.pi**2 * major * minor), "volume": rounded(2 * np.pi**2 * major * minor**2)}
    return points, {**axis_answers([axis], [minor], n_loops=1), **circle, **content}


def bent_tube(major: float = 2.0, minor: float = 0.4, n_points: int = 4000) -> Sample:
    """Quarter of a circle in z = 0 around the origin, swept by a ball of radius `minor`: ends are half balls."""
    rng = np.random.default_rng(4)
    length, caps = np.pi / 2 * major, 4 * np.pi * minor**2
    area, volume = 2 * np.pi * minor * length + caps, np.pi * minor**2 * (length + 4 / 3 * minor)
    n_caps = rng.binomial(n_points, caps / area)
    axis = arc(major, np.linspace(0, np.pi / 2, 33))
    side = points_on_arc_tube(rng, n_points - n_caps, major, minor, turn=np.pi / 2)
    points = np.r_[side, points_on_caps(rng, n_caps, axis[[0, -1]], np.array([[0, -1, 0], [-1, 0, 0]]), minor)]
    circle = {"major_radius": major, "minor_radius": minor, "length": rounded(length)}
    content = {"area": rounded(area), "volume": rounded(volume)}
    return rng.permutation(points), {**axis_answers([axis], [minor], axis[[0, -1]]), **circle, **content}


def points_on_arc_tube(rng: np.random.Generator, count: int, major: float, minor: float, *, turn: float) -> Floats:
    """Random points (count, 3), uniform by area, on the tube around an arc from the x axis through angle `turn`."""
    around = 2 * np.pi * rng.random(4 * count)
    outward = major + minor * np.cos(around)
    kept = np.flatnonzero(rng.random(4 * count) * (major + minor) < outward)[:count]  # area grows with the outer arc
    points = outward[kept, None] * arc(1.0, turn * rng.random(count))
    points[:, 2] = minor * np.sin(around[kept])
    return points


def points_on_caps(rng: np.random.Generator, count: int, centres: Floats, outward: Floats, radius: float) -> Floats:
    """Random points (count, 3) on the half spheres around `centres` (c, 3) that face `outward` (c, 3)."""
    which = rng.integers(len(centres), size=count)
    vectors = directions(rng, count)
    facing = np.where(dot(vectors, outward[which]) < 0, -1, 1)
    return centres[which] + radius * facing[:, None] * vectors


def arc(radius: float, angles: Floats) -> Floats:
    """Points (n, 3) at angles (n,) on a circle around the origin in z = 0."""
    return radius * np.c_[np.cos(angles), np.sin(angles), np.zeros(len(angles))]
