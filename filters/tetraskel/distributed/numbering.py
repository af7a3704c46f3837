"""Sums along a sequence that is spread over ranks: how many there are before each.

The elements of the sequence have numbers, and those of one rank come in runs of consecutive ones. Only runs are told
of, to the rank that counts their stretch of numbers: near the root of a tree they are short, but there are few
elements, and further down neighbours in the sequence are neighbours in space.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route

Ints = NDArray[np.integer]


def sums_before(comm: Communicator, numbers: Ints, weights: Ints, start: int, stop: int) -> tuple[Ints, int]:
    """For each number the sum of the weights of all smaller ones on all ranks, and the sum of all weights.

    Parameters
    ----------
    numbers : (k,) int
        This rank's, increasing; those of all ranks are the numbers from `start` to `stop`.
    weights : (k,) int
    """
    own = np.cumsum(weights) - weights
    heads = np.flatnonzero(np.diff(numbers, prepend=-2) != 1)
    totals = np.diff(np.append(own[heads], weights.sum()))
    own, first = comm.keep(own)[0], numbers[heads].astype(np.int64)
    route = Route(comm, (first - start) * comm.size // max(stop - start, 1))
    runs = route.forward(np.stack([first, totals], axis=1))
    order = np.argsort(runs[:, 0], kind="stable")
    sums = np.cumsum(runs[order, 1])
    shares = np.concatenate(comm.allgather(sums[-1:] if len(sums) else np.zeros(1, np.int64)))
    before = np.empty(len(runs), np.int64)
    before[order] = sums - runs[order, 1] + shares[: comm.rank].sum()
    bases = route.back(before)
    lengths = np.diff(np.append(heads, len(numbers)))
    return np.repeat(bases - own[heads], lengths) + own, int(shares.sum())


def owners_of(comm: Communicator, numbers: Ints, wanted: Ints, stop: int) -> Ints:
    """Rank that has each wanted number; `numbers` (k,) are this rank's, increasing, of those from 0 to `stop`."""
    share = max(-(-stop // comm.size), 1)
    heads = np.flatnonzero(np.diff(numbers, prepend=-2) != 1)
    ends = np.append(heads[1:], len(numbers)) - 1
    first, last = numbers[heads], numbers[ends] if len(heads) else numbers[:0]
    pieces = last // share - first // share + 1  # a run is told to every rank that keeps a part of its numbers
    run = np.repeat(np.arange(len(heads)), pieces)
    keeper = first[run] // share + np.arange(len(run)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    known = Route(comm, keeper)
    begins = known.forward(np.maximum(first[run], keeper * share))
    order = np.argsort(begins, kind="stable")
    asked = Route(comm, wanted // share)
    questions = asked.forward(wanted)
    at = np.searchsorted(begins[order], questions, side="right") - 1
    return asked.back(known.source[order][at].astype(np.int64))
