"""What ranks say to each other: a small protocol, the same over MPI and between threads of one process.

Every collective begins with a word from each rank whether it is well. A rank that failed answers that word, too, so
that the others learn of it in whatever collective they are, raise what it says, and nobody waits for ever.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import Aborted, RankError
from tetraskel.kernels.compilation import first_line

Array = NDArray[Any]
Ints = NDArray[np.integer]
Bytes = NDArray[np.uint8]
T = TypeVar("T")


class Communicator(ABC):
    """A rank's end of the line. Subclasses move bytes; arrays and agreement are made of them here.

    Attributes
    ----------
    rank, size : int
        Which rank this is, of how many.
    sent_bytes, received_bytes, exchanges : int
        Bytes sent to other ranks and received from them so far, and collectives taken part in.
    """

    rank: int
    size: int

    def __init__(self) -> None:
        self.sent_bytes = self.received_bytes = 0
        self.exchanges = 0
        self.failure: Exception | None = None  # of any rank: after it nobody listens any more

    @abstractmethod
    def all_well(self, well: bool) -> bool:
        """Whether every rank is well; all ranks get the same answer."""

    @abstractmethod
    def swap(self, messages: Sequence[Bytes]) -> list[Bytes]:
        """Send message k to rank k; what each rank sent here."""

    @abstractmethod
    def share(self, message: Bytes) -> list[Bytes]:
        """Send one message to everybody; everybody's."""

    def keep(self, *arrays: Array) -> list[Array]:
        """Arrays that outlast an exchange, to be used in place of those given; where ranks take turns, in a file."""
        return list(arrays)

    def packed(self, messages: list[Bytes]) -> list[Bytes]:
        """Messages ready to be sent."""
        return messages

    def agree(self) -> None:
        """Wait until all ranks have come here.

        Raises
        ------
        RankError
            When another rank failed: with what it says.
        """
        if self.failure is not None:
            raise self.failure
        if not self.all_well(True):
            self.failure = _failure_told(self.share(np.empty(0, np.uint8)))
            raise self.failure

    def fail(self, error: BaseException) -> None:
        """Tell the others, in whatever collective they are, why this rank cannot go on."""
        if self.failure is not None:
            return
        self.failure = RankError("this rank has failed before.")
        self.all_well(False)
        text = ("A" if isinstance(error, Aborted) else "E") + (first_line(error) if str(error) else repr(error))
        self.share(np.frombuffer(text.encode(), np.uint8))

    def alltoall(self, parts: Sequence[Array]) -> list[Array]:
        """Send array k to rank k; the arrays sent here. All have one type and one shape but for their length."""
        like = np.empty((0, *parts[0].shape[1:]), parts[0].dtype)
        messages = self.packed([_as_bytes(part) for part in parts])
        del parts  # what waits for others takes no room that it does not need
        self.agree()
        self.exchanges += 1
        self.sent_bytes += sum(len(message) for rank, message in enumerate(messages) if rank != self.rank)
        return self._received(self.swap(messages), like)

    def allgather(self, part: Array) -> list[Array]:
        """Everybody's array; all have one type and one shape but for their length."""
        like = np.empty((0, *part.shape[1:]), part.dtype)
        message = self.packed([_as_bytes(part)])[0]
        del part
        self.agree()
        self.exchanges += 1
        self.sent_bytes += len(message) * (self.size - 1)
        return self._received(self.share(message), like)

    def _received(self, messages: Sequence[Bytes], like: Array) -> list[Array]:
        self.received_bytes += sum(len(message) for rank, message in enumerate(messages) if rank != self.rank)
        return [_from_bytes(message, like) for message in messages]

    def gather(self, part: Array, root: int = 0) -> Array:
        """Everybody's arrays, one after another, on one rank; none on the others."""
        empty = np.empty((0, *part.shape[1:]), part.dtype)
        return np.concatenate(self.alltoall([part if rank == root else empty for rank in range(self.size)]))

    def from_first(self, part: Array) -> Array:
        """The first rank's array; what the others give says its type."""
        return self.allgather(part if self.rank == 0 else part[:0])[0]

    def sums(self, values: Array) -> Array:
        """Sums over the ranks of a few numbers."""
        return np.sum(self._stacked(values), axis=0, dtype=np.asarray(values).dtype)

    def lowest(self, values: Array) -> Array:
        """Minima over the ranks of a few numbers."""
        return np.min(self._stacked(values), axis=0)

    def highest(self, values: Array) -> Array:
        """Maxima over the ranks of a few numbers."""
        return np.max(self._stacked(values), axis=0)

    def _stacked(self, values: Array) -> Array:
        return np.stack(self.allgather(np.asarray(values)))

    def total(self, value: int) -> int:
        """Sum of a whole number over the ranks."""
        return int(self.sums(np.array([value], np.int64))[0])

    def before(self, value: int) -> int:
        """Sum of a whole number over the ranks before this one."""
        return int(np.concatenate(self.allgather(np.array([value], np.int64)))[: self.rank].sum())


def together(comm: Communicator, work: Callable[[], T]) -> T:
    """Do `work` on every rank; when it fails on one rank it fails on all, with what that rank says.

    Raises
    ------
    RankError
        On the ranks that did not fail themselves; the others raise their own error.
    """
    try:
        result = work()
    except BaseException as error:
        comm.fail(error)
        raise
    comm.agree()
    return result


class Route:
    """Rows on their way to the ranks they are for, and answers on the way back.

    Parameters
    ----------
    destination : (k,) int
        Rank each row goes to.

    """

    def __init__(self, comm: Communicator, destination: Ints) -> None:
        self.comm = comm
        self.order: Ints = comm.keep(_stable_order(destination, comm.size))[0]
        self.ends = np.cumsum(np.bincount(destination, minlength=comm.size))
        self._received_ends = np.zeros(comm.size, np.intp)

    @classmethod
    def by_keys(cls, comm: Communicator, keys: NDArray[np.uint64]) -> Route:
        """The way to where rows with the same key of all ranks meet; keys are to look random (`scramble`)."""
        return cls(comm, (keys % np.uint64(comm.size)).astype(np.intp))

    @property
    def source(self) -> Ints:
        """(r,) rank each received row came from; known after the first `forward`."""
        return np.repeat(np.arange(self.comm.size), np.diff(self._received_ends, prepend=0))

    def forward(self, rows: Array) -> Array:
        """The rows (k, ...) for this rank, in the order of their ranks and there in their order."""
        parts = self.comm.alltoall(np.split(rows[self.order], self.ends[:-1]))
        self._received_ends = np.cumsum([len(part) for part in parts])
        return self.comm.keep(np.concatenate(parts))[0]

    def back(self, answers: Array) -> Array:
        """Answers (r, ...) to the received rows, on the ranks that asked, in the order in which they had the rows."""
        received = np.concatenate(self.comm.alltoall(np.split(answers, self._received_ends[:-1])))
        found = np.empty_like(received)
        found[self.order] = received
        return self.comm.keep(found)[0]


def index_type(n: int) -> type[np.signedinteger[Any]]:
    """The smallest type for indices of n items: 32 bits almost always."""
    return np.int32 if n <= np.iinfo(np.int32).max else np.int64


def _stable_order(destination: Ints, size: int) -> Ints:
    """Indices that sort rows by their destination; sorting small numbers is quicker and takes less room."""
    small = destination.astype(np.uint8 if size <= 256 else np.int32, copy=False)
    return np.argsort(small, kind="stable").astype(index_type(len(small)), copy=False)


def _failure_told(messages: Sequence[Bytes]) -> Exception:
    """What the first rank that failed says."""
    texts = {rank: bytes(message).decode() for rank, message in enumerate(messages) if len(message)}
    rank, text = next(iter(texts.items()))
    kind = Aborted if text[0] == "A" else RankError
    return kind(f"rank {rank}: {text[1:]}")


def _as_bytes(part: Array) -> Bytes:
    return np.ascontiguousarray(part).reshape(-1).view(np.uint8)


def _from_bytes(message: Bytes, like: Array) -> Array:
    return message.view(like.dtype).reshape(-1, *like.shape[1:])
