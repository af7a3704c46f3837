"""Which simplices of a triangulation lie inside the object, by whatever is known of it."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError, InsideWarning
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.denoise import lies_on_surface
from tetraskel.kernels.gates import gate_tree, inside_by_gates
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.noise import noise_at_gates
from tetraskel.kernels.outline import checked_outline, even_odd
from tetraskel.kernels.smoothing import smaller_surface
from tetraskel.kernels.surface_side import inside_by_surface
from tetraskel.options import InteriorOptions

Bools = NDArray[np.bool_]

# Of points on a surface nearly all lie between inside and outside, with noise of 1 % of the diagonal about half. Of
# points that fill an area less than half do, however the gates divide them; in space gates find no room in a volume of
# points anyway (none in a million uniform ones), so less is asked there.
LEAST_SHARE = {2: 0.5, 3: 0.3}
# Tried one after another when no room is as many times larger than its door as asked: the widest of the gaps between
# few random points is not much narrower than the object is thick. In a volume of points this finds rooms, too.
SPARSE_RATIOS = (1.5, 1.25, 1.02)


def interior(
    mesh: Triangulation,
    *,
    method: str = InteriorOptions.method,
    ratio: float = InteriorOptions.ratio,
    noise: float = InteriorOptions.noise,
    surface: tuple[ArrayLike, ArrayLike] | None = None,
    outline: tuple[ArrayLike, ArrayLike] | None = None,
    labels: ArrayLike | None = None,
    tick: Tick = silent,
) -> Bools:
    """(m,) simplices that lie inside.

    Parameters
    ----------
    mesh : Triangulation
        A Delaunay triangulation.
    method : {"gates", "surface", "outline", "array", "all"}
        See `InteriorOptions`.
    ratio, noise : float
        See `InteriorOptions`; for "gates".
    surface : (points (n, 3), triangles (t, 3)), optional
        For "surface": closed, counter-clockwise as seen from outside.
    outline : (points (k, 2), segments (s, 2)), optional
        For "outline": closed lines. Triangles that the outline cuts are on their barycentre's side;
        `inside_by_outline` makes a triangulation that follows the outline first.
    labels : (m,) array of numbers or booleans
        For "array": what is not 0 is inside.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        When an option is out of bounds or what a method needs is missing or of the wrong length.

    Warns
    -----
    InsideWarning
        When nothing lies inside, or only rooms smaller than asked do.
    """
    InteriorOptions(method=method, ratio=ratio, noise=noise)
    if method == "all" or len(mesh) == 0:
        return np.ones(len(mesh), bool)
    if method == "array":
        return inside_by_labels(len(mesh), labels)
    if method == "surface":
        return inside_by_surface(mesh, *_needed(surface, method), tick=tick)
    if method == "outline":
        corners, edges = checked_outline(mesh, *_needed(outline, method))
        return even_odd(mesh.points[mesh.simplices].mean(axis=1), corners, edges)
    inside, said = told_by_gates(_WholeMesh(mesh, noise, part(tick, 0.0, 0.9)), ratio, tick)
    for message in said:
        warnings.warn(message, InsideWarning, stacklevel=2)
    return inside


def _needed(given: tuple[ArrayLike, ArrayLike] | None, method: str) -> tuple[ArrayLike, ArrayLike]:
    if given is None:
        raise InputError(f"expected a second input for method {method!r}, got none; give its points and cells.")
    return given


class Classified(ABC):
    """A mesh, whole or in parts, as `told_by_gates` asks of it; (m,) are the simplices of this part.

    Attributes
    ----------
    dim : int
        Dimension of the simplices.
    """

    dim: int

    @abstractmethod
    def behind_doors(self, ratio: float) -> Bools:
        """(m,) inside by gates, where rooms are this many times larger than doors."""

    @abstractmethod
    def is_any(self, inside: Bools) -> bool:
        """Whether anything lies inside."""

    @abstractmethod
    def lies_on_surface(self) -> bool:
        """Whether the points lie on a surface."""

    @abstractmethod
    def smaller_surface(self, inside: Bools) -> Bools:
        """(m,) inside after `smoothing.smaller_surface`."""

    @abstractmethod
    def surface_share(self, inside: Bools) -> float:
        """Share of the points that lie between the sides."""


class _WholeMesh(Classified):
    """All of a mesh."""

    def __init__(self, mesh: Triangulation, noise: float, tick: Tick) -> None:
        self.mesh, self.dim = mesh, mesh.dim
        self.tree = gate_tree(mesh, tick=tick)
        self.least_width = noise * noise_at_gates(mesh, self.tree) if noise else 0.0

    def behind_doors(self, ratio: float) -> Bools:
        return inside_by_gates(self.tree, ratio=ratio, least_width=self.least_width)

    def is_any(self, inside: Bools) -> bool:
        return bool(inside.any())

    def lies_on_surface(self) -> bool:
        return lies_on_surface(self.mesh.coordinates)

    def smaller_surface(self, inside: Bools) -> Bools:
        return smaller_surface(self.mesh, inside)

    def surface_share(self, inside: Bools) -> float:
        return surface_share(self.mesh, inside)


def told_by_gates(mesh: Classified, ratio: float, tick: Tick) -> tuple[Bools, list[str]]:
    """(m,) simplices that lie inside, by the gates; and what is to be said of it as `InsideWarning`s."""
    inside, said = mesh.behind_doors(ratio), []
    tick(0.93)
    if not mesh.is_any(inside) and mesh.lies_on_surface():
        inside, lowered = _by_smaller_ratio(mesh, inside, ratio)
        if lowered < ratio:
            said.append(
                f"no room is {ratio:g} times larger than its door; taken for inside is what is {lowered:g} times "
                "larger, as the points are few for the thickness of the object."
            )
    if mesh.dim == 3:  # in the plane only ears could gain, which are corners of the outline
        inside = mesh.smaller_surface(inside)
    tick(0.97)
    share, is_any = mesh.surface_share(inside), mesh.is_any(inside)
    tick(1.0)
    if is_any and share >= LEAST_SHARE[mesh.dim]:
        return inside, said
    if is_any:
        reason = f"only {share:.0%} of the points lie between inside and outside; they fill a volume or are too noisy"
        advice = "try method 'all', or 'surface' if there is one"
    else:
        reason = (
            f"no room is {ratio:g} times larger than the widest way into it; the points lie on an open surface, on a "
            "line, fill a volume, or are too few for the thickness of the object"
        )
        advice = "try method 'all', or a smaller ratio"
    return np.zeros(len(inside), bool), [*said, f"nothing lies inside: {reason}; {advice}."]


def _by_smaller_ratio(mesh: Classified, inside: Bools, ratio: float) -> tuple[Bools, float]:
    """The inside by the first of the smaller ratios that finds one, and that ratio; else what it was."""
    for lowered in SPARSE_RATIOS:
        if lowered < ratio:
            found = mesh.behind_doors(lowered)
            if mesh.is_any(found):
                return found, lowered
    return inside, ratio


def surface_share(mesh: Triangulation, inside: Bools) -> float:
    """Share of the points that have simplices of both sides around them, or the outside of the mesh."""
    return float(np.count_nonzero(touched_sides(mesh, inside).all(axis=0)) / max(len(mesh.points), 1))


def touched_sides(mesh: Triangulation, inside: Bools) -> Bools:
    """(2, n) whether each point has simplices outside, and inside, around it; beyond the mesh is outside, too."""
    touched = np.zeros((2, len(mesh.points)), bool)
    touched[1, mesh.simplices[inside]] = True
    touched[0, mesh.simplices[~inside]] = True
    cells = np.flatnonzero(inside & (mesh.neighbors < 0).any(axis=1))
    for vertex in range(mesh.dim + 1):
        at_hull = cells[mesh.neighbors[cells, vertex] < 0]
        touched[0, np.delete(mesh.simplices[at_hull], vertex, axis=1)] = True
    return touched


def inside_of_object(mesh: Triangulation, labels: ArrayLike | None = None, tick: Tick = silent) -> Bools:
    """(m,) simplices inside: as labelled; without labels all of a mesh that others made, else what the gates find.

    For those who draw an object: to them nothing inside is an error, with a sentence of its own, and no warning.
    """
    if labels is not None:
        return inside_by_labels(len(mesh), labels)
    if mesh.engine == "given":
        return np.ones(len(mesh), bool)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InsideWarning)
        return interior(mesh, tick=tick)


def inside_by_labels(n_simplices: int, labels: ArrayLike | None) -> Bools:
    """(m,) simplices whose label is not 0.

    Raises
    ------
    InputError
        When there are no labels, not one number per simplex, or labels that are not numbers.
    """
    if labels is None:
        raise InputError("expected labels for method 'array', got none; name a cell array of the mesh.")
    given = np.asarray(labels)
    if given.shape != (n_simplices,):
        raise InputError(f"expected one label for each of {n_simplices} simplices, got shape {given.shape}.")
    if given.dtype.kind not in "biuf":
        raise InputError(f"expected labels as numbers or booleans, got an array of type {given.dtype}.")
    if given.dtype.kind == "f" and not np.isfinite(given).all():
        raise InputError("expected finite labels, got NaN or infinity.")
    return np.asarray(given != 0)
