"""The case table of marching cubes and squares, made from one rule, and contouring of blocks of values with it.

The surface of a cell (Lorensen and Cline 1987) follows from its corners alone. On every face it runs from a side
where the values become positive to one where they become negative; where a face has two of each, the negative corners
are joined. Both cells at a face see the same, so no gap opens. The lines on the faces close to loops, one way round
by construction. Diagonals that split a loop into triangles never lie in a face: the cell behind it could have the
same one, and four triangles would meet there. Hence a closed manifold, whatever the values.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

Loop = tuple[int, ...]
CLEAR = 1e-3  # of a side: crossings stay off the corners, so that no two of them coincide


@dataclass(frozen=True)
class CaseTable:
    """What each case of signs at the corners of a cell holds.

    Corner c of a cell has the coordinates given by the bits of c, lowest first; a case has bit c set where corner c is
    negative (inside).

    Attributes
    ----------
    side_corner, side_axis : (e,) int
        Lower corner and direction of each side (grid edge) of the cell.
    offsets : (2**2**d + 1,) int
        Pieces of case k are `pieces[offsets[k]:offsets[k+1]]`.
    pieces : (..., d) int
        Sides crossed by the corners of each line (2D, inside to the left) or triangle (3D, counter-clockwise from
        outside).
    """

    side_corner: Ints
    side_axis: Ints
    offsets: Ints
    pieces: Ints


@lru_cache(maxsize=2)
def case_table(dim: int) -> CaseTable:
    """The table for squares (2) or cubes (3)."""
    sides = [(corner, axis) for axis in range(dim) for corner in range(1 << dim) if not corner >> axis & 1]
    number = {frozenset((corner, corner | 1 << axis)): k for k, (corner, axis) in enumerate(sides)}
    pieces = [
        _lines(case, number) if dim == 2 else [t for loop in _loops(case, number) for t in _split(loop, sides)]
        for case in range(1 << (1 << dim))
    ]
    offsets = np.concatenate([[0], np.cumsum([len(some) for some in pieces])])
    flat = np.array([piece for some in pieces for piece in some], dtype=np.int64).reshape(-1, dim)
    corner, axis = np.array(sides).T
    return CaseTable(corner, axis, offsets.astype(np.int64), flat)


def _arcs(ring: list[int], case: int, number: dict[frozenset[int], int]) -> list[Loop]:
    """Pairs of crossed sides joined across a face, its corners in the order of a walk around it.

    From the side by which the walk leaves the inside to the one by which it enters it again.
    """
    inside = [case >> corner & 1 for corner in ring]
    n = len(ring)
    leaves = [k for k in range(n) if inside[k] and not inside[(k + 1) % n]]
    arcs = []
    for k in leaves:
        back = next(j % n for j in range(k + 1, k + n) if not inside[j % n] and inside[(j + 1) % n])
        arcs.append(tuple(number[frozenset((ring[j], ring[(j + 1) % n]))] for j in (k, back)))
    return arcs


def _lines(case: int, number: dict[frozenset[int], int]) -> list[Loop]:
    """Lines of a square with the inside to their left."""
    return _arcs([0, 1, 3, 2], case, number)


def _loops(case: int, number: dict[frozenset[int], int]) -> list[Loop]:
    """Closed loops of crossed sides of a cube."""
    after = {first: then for ring in _rings() for first, then in _arcs(ring, case, number)}
    loops = []
    while after:
        first = min(after)
        loop = [first]
        while (side := after.pop(loop[-1])) != first:
            loop.append(side)
        loops.append(tuple(loop))
    return loops


def _rings() -> list[list[int]]:
    """The corners of the six faces of a cube, clockwise as seen from outside."""
    rings = []
    for axis, side in product(range(3), (0, 1)):
        u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
        ring = [side << axis | bits for bits in (0, u, u | v, v)]
        rings.append(ring[::-1] if side else ring)
    return rings


def _split(loop: Loop, sides: list[tuple[int, int]]) -> list[Loop]:
    """Triangles of a loop, without a diagonal in a face of the cube; the first such split in lexicographic order."""
    faces = [_faces_of(*sides[side]) for side in loop]

    def splits(chain: tuple[int, ...]) -> list[list[Loop]]:
        if len(chain) < 3:
            return [[]]
        first, last = chain[0], chain[-1]
        found = []
        for k in range(1, len(chain) - 1):
            diagonals = [
                pair for pair, gap in (((first, chain[k]), k), ((chain[k], last), len(chain) - 1 - k)) if gap > 1
            ]
            if any(faces[a] & faces[b] for a, b in diagonals):
                continue
            triangle = (loop[first], loop[chain[k]], loop[last])
            found += [[triangle, *left, *right] for left in splits(chain[: k + 1]) for right in splits(chain[k:])]
        return found

    return splits(tuple(range(len(loop))))[0]


def _faces_of(corner: int, axis: int) -> set[tuple[int, int]]:
    """The two faces a side lies in, as (axis, which)."""
    return {(other, corner >> other & 1) for other in range(3) if other != axis}


@dataclass(frozen=True)
class Pieces:
    """Lines or triangles by the grid edges their corners lie on.

    Attributes
    ----------
    keys : (v,) int
        Grid edges crossed, by the number of their lower place times d plus their direction; each once, not sorted.
    block : (v,) int
        Block each was found in.
    share : (v,) float
        Where each is crossed, from the lower place to the upper one.
    pieces : (t, d) int
        Keys of the corners of each piece.
    """

    keys: Ints
    block: Ints
    share: Floats
    pieces: Ints


def contour_blocks(values: Floats, corner: Ints, shape: Ints) -> Pieces:
    """The surface where the values in blocks pass through 0; negative is inside, 0 outside.

    Parameters
    ----------
    values : (n+1, ..., n+1, k) float
    corner : (k, d) int
        Lowest place of each block on the grid; blocks begin a multiple of n apart.
    shape : (d,) int
        Places of the whole grid.
    """
    dim = corner.shape[1]
    inside = values < 0
    strides = np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.int64)  # from coordinates to number of a place
    first = corner @ strides
    keys, owners, shares = [], [], []
    for axis in range(dim):
        *place, block = _crossed(inside, axis)
        ahead = [at + (k == axis) for k, at in enumerate(place)]
        low, high = values[(*place, block)], values[(*ahead, block)]
        keys.append((first[block] + np.stack(place, axis=1) @ strides) * dim + axis)
        owners.append(block)
        shares.append(np.clip(low / (low - high), CLEAR, 1 - CLEAR))
    pieces = _pieces(inside, first, strides)
    return Pieces(np.concatenate(keys), np.concatenate(owners), np.concatenate(shares), pieces)


def _crossed(inside: NDArray[np.bool_], axis: int) -> tuple[Ints, ...]:
    """Lower place and block of the grid edges along `axis` that are crossed and begin in the block's own cells."""
    dim = inside.ndim - 1
    ahead = tuple(slice(1, None) if k == axis else slice(-1) for k in range(dim))
    return np.nonzero(inside[(slice(-1),) * dim] != inside[ahead])


def _pieces(inside: NDArray[np.bool_], first: Ints, strides: Ints) -> Ints:
    """Keys of the corners of all pieces, cell by cell."""
    dim = inside.ndim - 1
    table = case_table(dim)
    ends = (slice(-1), slice(1, None))
    case = np.zeros(inside[(slice(-1),) * dim].shape, np.uint8)
    for corner in range(1 << dim):
        part = inside[tuple(ends[corner >> axis & 1] for axis in range(dim))]
        case |= part.view(np.uint8) << np.uint8(corner)
    case = np.moveaxis(case, -1, 0)  # block after block, however many come at a time
    block, *place = np.nonzero((case > 0) & (case < (1 << (1 << dim)) - 1))
    kind = case[(block, *place)].astype(np.int64)
    number = first[block] + np.stack(place, axis=1) @ strides
    count = np.diff(table.offsets)[kind]
    cell = np.repeat(np.arange(len(kind)), count)
    rank = np.arange(len(cell)) - np.repeat(np.cumsum(count) - count, count)
    sides = table.pieces[table.offsets[kind[cell]] + rank]
    corner_shift = (np.arange(1 << dim)[:, None] >> np.arange(dim) & 1) @ strides
    side_shift = corner_shift[table.side_corner] * dim + table.side_axis
    return (number[cell] * dim)[:, None] + side_shift[sides]
