"""The definition of the tree, word for word, in exact arithmetic: slow, and written to be read beside it.

No code of the package is used: a mesh is points, simplices and neighbours, as lists.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from fractions import Fraction


@dataclass
class Node:
    cell: int
    entry_facet: frozenset[int]
    parent: int
    depth: int
    son_rank: int
    tree: int = 0


class Reference:
    """Exact geometry of a triangulation in 2D or 3D."""

    def __init__(self, points, simplices, neighbors):
        self.points = [tuple(Fraction(float(x)) for x in point) for point in points]
        self.simplices = [tuple(int(v) for v in simplex) for simplex in simplices]
        self.neighbors = [tuple(int(v) for v in row) for row in neighbors]
        self.dim = len(self.simplices[0]) - 1

    def barycentre(self, ids):
        return tuple(sum(self.points[i][axis] for i in ids) / len(ids) for axis in range(self.dim))

    def hull_facets(self):
        """(facet, cell) pairs on the border."""
        for cell, row in enumerate(self.neighbors):
            for k, neighbor in enumerate(row):
                if neighbor < 0:
                    yield self.facet(cell, k), cell

    def facet(self, cell, k):
        return frozenset(v for j, v in enumerate(self.simplices[cell]) if j != k)

    def root(self, cells):
        """Smallest barycentre, first coordinate first; exact ties by the smallest sorted point ids."""
        candidates = [
            (self.barycentre(facet), sorted(facet), cell) for facet, cell in self.hull_facets() if cell in cells
        ]
        _, facet, cell = min(candidates)
        return frozenset(facet), cell

    def across(self, cell, facet):
        for k in range(self.dim + 1):
            if self.facet(cell, k) == facet:
                return self.neighbors[cell][k]
        raise AssertionError("no such facet")

    def orientation(self, a, b, c, *more):
        """Sign of the volume of simplex (a, b, c) or (a, b, c, d); without volume, that of the sorted corners."""
        ids = (a, b, c, *more)
        rows = [[self.points[i][axis] - self.points[a][axis] for axis in range(self.dim)] for i in ids[1:]]
        if self.dim == 2:
            value = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
        else:
            (p, q, r), (s, t, u), (v, w, x) = rows
            value = p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v)
        if value != 0:
            return 1 if value > 0 else -1
        corners = [self.points[i] for i in ids]
        inversions = sum(corners[i] > corners[j] for i in range(len(ids)) for j in range(i + 1, len(ids)))
        return -1 if inversions % 2 else 1

    def ahead(self, cell, entry_facet):
        """The facets that can be crossed, in order."""
        return self.ahead_2d(cell, entry_facet) if self.dim == 2 else self.ahead_3d(cell, entry_facet)

    def ahead_2d(self, cell, entry_edge):
        """The left edge, then the right one, as seen from the entry edge."""
        (apex,) = set(self.simplices[cell]) - entry_edge
        a, b = sorted(entry_edge)
        if self.orientation(a, b, apex) < 0:
            a, b = b, a  # now the apex is on the left of a -> b: who looks in has a on the left
        return [frozenset((a, apex)), frozenset((b, apex))]

    def ahead_3d(self, cell, entry_facet):
        """First the facet of smallest z by the tie rules, the others counter-clockwise as seen from the entry."""
        (apex,) = set(self.simplices[cell]) - entry_facet
        in_row_order = [v for v in self.simplices[cell] if v in entry_facet]
        facets = [frozenset(set(self.simplices[cell]) - {v}) for v in in_row_order]
        first = self.first_of_three(facets)
        a, b, c = in_row_order
        if self.orientation(a, b, c, apex) > 0:
            a, b, c = a, c, b  # seen from the apex a, b, c turned left; seen from outside the entry they turn right
        counter_clockwise = [frozenset(set(self.simplices[cell]) - {v}) for v in (a, b, c)]
        at = counter_clockwise.index(first)
        return counter_clockwise[at:] + counter_clockwise[:at]

    def first_of_three(self, facets):
        for axis in (2, 0, 1):
            values = [self.barycentre(facet)[axis] for facet in facets]
            smallest = [facet for facet, value in zip(facets, values, strict=True) if value == min(values)]
            if len(smallest) == 1:
                return smallest[0]
            if len(smallest) == 2:
                (remaining,) = [facet for facet in facets if facet not in smallest]
                return remaining
        return facets[0]

    def piece(self, start):
        seen, todo = {start}, [start]
        while todo:
            for neighbor in self.neighbors[todo.pop()]:
                if neighbor >= 0 and neighbor not in seen:
                    seen.add(neighbor)
                    todo.append(neighbor)
        return seen

    def roots(self):
        """A root per piece, in the order of the root facets."""
        left, roots = set(range(len(self.simplices))), []
        while left:
            piece = self.piece(min(left))
            left -= piece
            facet, cell = self.root(piece)
            roots.append((self.barycentre(facet), sorted(facet), cell))
        return [(frozenset(facet), cell) for _, facet, cell in sorted(roots)]

    def breadth_first(self):
        """A first-in-first-out queue; one node per simplex; the first to reach a simplex has it."""
        nodes: list[Node] = []
        taken: set[int] = set()
        for tree, (facet, cell) in enumerate(self.roots()):
            queue = deque([len(nodes)])
            nodes.append(Node(cell, facet, -1, 0, 0, tree))
            taken.add(cell)
            while queue:
                number = queue.popleft()
                node, rank = nodes[number], 0
                for crossed in self.ahead(node.cell, node.entry_facet):
                    target = self.across(node.cell, crossed)
                    if target >= 0 and target not in taken:
                        taken.add(target)
                        queue.append(len(nodes))
                        nodes.append(Node(target, crossed, number, node.depth + 1, rank, tree))
                        rank += 1
        return nodes

    def depth_first(self):
        """Follow the first son to its end, then the next: the recursion, with a stack of what is still to be tried."""
        nodes: list[Node] = []
        taken: set[int] = set()
        for tree, (facet, cell) in enumerate(self.roots()):
            nodes.append(Node(cell, facet, -1, 0, 0, tree))
            taken.add(cell)
            stack = [(len(nodes) - 1, iter(self.ahead(cell, facet)))]
            sons = {len(nodes) - 1: 0}
            while stack:
                number, facets = stack[-1]
                crossed = next(facets, None)
                if crossed is None:
                    stack.pop()
                    continue
                target = self.across(nodes[number].cell, crossed)
                if target >= 0 and target not in taken:
                    taken.add(target)
                    nodes.append(Node(target, crossed, number, nodes[number].depth + 1, sons[number], tree))
                    sons[number] += 1
                    sons[len(nodes) - 1] = 0
                    stack.append((len(nodes) - 1, iter(self.ahead(target, crossed))))
        return nodes


def contracted(parents, flat):
    """Flat removal by definition, on nested lists: returns {kept node: [its sons in order]} and the roots.

    `parents` are in the order of the traversal, siblings in the order of their ranks.
    """
    sons: dict[int, list[int]] = {node: [] for node in range(len(parents))}
    for node, parent in enumerate(parents):
        if parent >= 0:
            sons[parent].append(node)

    def kept_in_place(node):
        if not flat[node]:
            return [node]
        return [kept for son in sons[node] for kept in kept_in_place(son)]

    result = {node: [kept for son in sons[node] for kept in kept_in_place(son)] for node in sons if not flat[node]}
    roots = []
    for root in (node for node, parent in enumerate(parents) if parent < 0):
        heirs = kept_in_place(root)
        if heirs:
            first = min(heirs)  # the first in the order of the traversal
            at = heirs.index(first)
            result[first] = heirs[:at] + result[first] + heirs[at + 1 :]
            roots.append(first)
    return result, roots
