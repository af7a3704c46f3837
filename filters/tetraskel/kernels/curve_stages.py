"""The stages of a curve skeleton's model: the shares of its work and the texts of its progress, from one table."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise

from tetraskel.kernels.chunks import Tick, part

# about the share of the work done when a stage ends
ENDS = {
    "Telling inside from outside": 0.25,
    "Placing the nodes": 0.45,
    "Joining the nodes": 0.55,
    "Collapsing to a graph": 0.65,
    "Finding the loops": 0.7,
    "Burning from the surface": 0.8,
    "Growing the tree": 0.92,
    "Growing the branches": 1.0,
}
_SPANS = dict(zip(ENDS, pairwise((0.0, *ENDS.values())), strict=True))


def begin_stage(tick: Tick, stage: str, start: float = 0.0, stop: float = 1.0) -> Tick:
    """A tick for a stage of the model, or for the part of it between two of its shares; told of its start at once."""
    of_stage = part(part(tick, *_SPANS[stage]), start, stop)
    of_stage(0.0)
    return of_stage


def stage_at(share: float) -> str:
    """The stage that is at work when this share of the model is done.

    Examples
    --------
    >>> stage_at(0.0), stage_at(0.46), stage_at(1.0)
    ('Telling inside from outside', 'Joining the nodes', 'Growing the branches')
    """
    return list(ENDS)[min(bisect_right(list(ENDS.values()), share), len(ENDS) - 1)]
