"""Ranks as threads of one process: what tests, benchmarks and small machines use instead of MPI."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, together
from tetraskel.errors import RankError

Bytes = NDArray[np.uint8]
T = TypeVar("T")


class _Board:
    """Where the threads of one run meet: a place for each rank's word, and a barrier."""

    def __init__(self, size: int) -> None:
        self.words: list[Any] = [None] * size
        self.barrier = threading.Barrier(size)


class ThreadCommunicator(Communicator):
    """One of several ranks in a process."""

    def __init__(self, board: _Board, rank: int) -> None:
        super().__init__()
        self.board, self.rank, self.size = board, rank, len(board.words)

    def all_well(self, well: bool) -> bool:
        """See `Communicator.all_well`."""
        return all(self._exchanged(well))

    def swap(self, messages: Sequence[Bytes]) -> list[Bytes]:
        """See `Communicator.swap`."""
        return [sent[self.rank].copy() for sent in self._exchanged(list(messages))]

    def share(self, message: Bytes) -> list[Bytes]:
        """See `Communicator.share`."""
        return [sent.copy() for sent in self._exchanged(message)]

    def _exchanged(self, word: Any) -> list[Any]:
        """Everybody's words; nobody writes the next ones before all have read these."""
        try:
            self.board.words[self.rank] = word
            self.board.barrier.wait()
            words = list(self.board.words)
            self.board.barrier.wait()
        except threading.BrokenBarrierError:
            self.failure = RankError("another rank ended without a word; look at its output.")
            raise self.failure from None
        return words


def run_on_ranks(size: int, work: Callable[[Communicator], T]) -> list[T]:
    """Call `work(communicator)` on `size` ranks at once; what each returned, in order.

    Raises
    ------
    Exception
        What a rank raised first; the others stop with it.
    """
    board = _Board(size)

    def run(rank: int) -> T:
        comm = ThreadCommunicator(board, rank)
        return together(comm, lambda: work(comm))

    return joined(size, run)


def joined(size: int, run: Callable[[int], T], stop: Callable[[], None] = lambda: None) -> list[T]:
    """Call `run(rank)` in a thread for each rank; what each returned, in order.

    Raises
    ------
    Exception
        What a rank raised first. When the caller is interrupted meanwhile, `stop` is called to end the threads.
    """
    results: list[Any] = [None] * size
    failures: list[BaseException] = []

    def work(rank: int) -> None:
        try:
            results[rank] = run(rank)
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=work, args=(rank,), daemon=True) for rank in range(size)]
    for thread in threads:
        thread.start()
    try:
        _wait_for(threads)
    except BaseException:
        stop()
        _wait_for(threads)
        raise
    if failures:
        raise min(failures, key=lambda error: str(error).startswith("rank "))
    return results


def _wait_for(threads: Sequence[threading.Thread]) -> None:
    for thread in threads:
        thread.join()
