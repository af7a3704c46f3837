"""Ranks that take turns in one process, their arrays in files: data larger than memory, block after block."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Array, Communicator, together
from tetraskel.distributed.in_process import joined
from tetraskel.distributed.shelf import Shelf
from tetraskel.errors import Aborted, RankError

Bytes = NDArray[np.uint8]
T = TypeVar("T")

# What `mallopt` of the GNU C library sets (malloc.h), so that freed arrays go back to the system at once.
TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8
LARGE = 1 << 18  # bytes
FILES_PER_BLOCK, OTHER_FILES = 128, 256


class _Table:
    """Where the ranks of one run sit: whose turn it is, and the words of this exchange and of the next.

    Nobody speaks a third time before all have heard the first word, so two places for each rank are enough.
    """

    def __init__(self, size: int) -> None:
        self.words: list[list[Any]] = [[None] * size, [None] * size]
        self.turns = [threading.Semaphore(int(rank == 0)) for rank in range(size)]
        self.gone = [False] * size
        self.broken = self.stopped = False

    def wait_for_turn(self, rank: int) -> None:
        self.turns[rank].acquire()

    def pass_turn(self, rank: int) -> None:
        """To the next rank that is still there."""
        size = len(self.turns)
        others = ((rank + step) % size for step in range(1, size + 1))
        following = next((other for other in others if not self.gone[other]), None)
        if following is not None:
            self.turns[following].release()

    def leave(self, rank: int, *, broken: bool) -> None:
        self.gone[rank] = True
        self.broken |= broken
        self.pass_turn(rank)


class TurnCommunicator(Communicator):
    """One of several ranks of which only one works at a time, from one exchange to the next.

    What it keeps, and large messages, are in files; at the end of a turn nothing of them stays in memory.
    """

    def __init__(self, table: _Table, rank: int, folder: Path) -> None:
        super().__init__()
        self.table, self.rank, self.size = table, rank, len(table.gone)
        self.shelf = Shelf(folder)
        self._exchanges = 0

    def keep(self, *arrays: Array) -> list[Array]:
        """See `Communicator.keep`."""
        return self.shelf.put(*arrays)

    def agree(self) -> None:
        """See `Communicator.agree`; who is asked to stop, stops here."""
        self.check()
        super().agree()

    def check(self) -> None:
        """Raise `Aborted` when the whole run was asked to stop."""
        if self.table.stopped and self.failure is None:
            raise Aborted("stopped on request.")

    def all_well(self, well: bool) -> bool:
        """See `Communicator.all_well`."""
        return all(self._exchanged(well))

    def swap(self, messages: Sequence[Bytes]) -> list[Bytes]:
        """See `Communicator.swap`."""
        return [sent[self.rank] for sent in self._exchanged(list(messages))]

    def share(self, message: Bytes) -> list[Bytes]:
        """See `Communicator.share`."""
        return list(self._exchanged(message))

    def packed(self, messages: list[Bytes]) -> list[Bytes]:
        """See `Communicator.packed`: others read them after this rank has gone on, so they are copies."""
        kept = self.shelf.put(*messages)
        return [message.copy() if message is own else message for message, own in zip(kept, messages, strict=True)]

    def _exchanged(self, word: Any) -> list[Any]:
        """Everybody's words, when it is this rank's turn again."""
        words = self.table.words[self._exchanges % 2]
        self._exchanges += 1
        words[self.rank] = word
        self.shelf.leave()
        self.table.pass_turn(self.rank)
        self.table.wait_for_turn(self.rank)
        if self.table.broken:
            self.failure = RankError("another block ended without a word.")
            raise self.failure
        return list(words)


def run_in_turn(size: int, work: Callable[[TurnCommunicator], T], folder: Path) -> list[T]:
    """Call `work(communicator)` on `size` ranks that take turns, with their files in `folder`; what each returned.

    Raises
    ------
    Exception
        What a rank raised first; the others stop with it. Ctrl-C stops them all.
    """
    table = _Table(size)
    _return_memory_at_once()
    _allow_files(FILES_PER_BLOCK * size + OTHER_FILES)

    def run(rank: int) -> T:
        comm = TurnCommunicator(table, rank, folder)
        table.wait_for_turn(rank)
        well = False
        try:
            result = together(comm, lambda: work(comm))
            well = True
        finally:
            comm.shelf.leave()
            table.leave(rank, broken=not well and comm.failure is None)
        return result

    def stop() -> None:
        table.stopped = True

    return joined(size, run, stop)


def _return_memory_at_once() -> None:
    """Let freed arrays go back to the system, where the C library can: each thread would keep some for itself."""
    try:
        settings = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):  # another C library
        return
    for name, value in ((ARENA_MAX, 1), (MMAP_THRESHOLD, LARGE), (TRIM_THRESHOLD, LARGE)):
        settings(name, value)


def _allow_files(n: int) -> None:
    """Let this process hold n files open, as far as the system lets it: every array on a shelf is one."""
    try:
        import resource
    except ImportError:  # Windows, where there are enough
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < n:
        with suppress(ValueError, OSError):  # a system may allow less than it says
            resource.setrlimit(resource.RLIMIT_NOFILE, (n if hard == resource.RLIM_INFINITY else min(n, hard), hard))
