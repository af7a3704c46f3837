"""Ranks of MPI, through mpi4py: the one that comes with ParaView."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator

Bytes = NDArray[np.uint8]


class MpiCommunicator(Communicator):
    """A rank of an mpi4py communicator.

    Messages of more than 2**31 bytes between two ranks are beyond what MPI counts; such data need more ranks.
    """

    def __init__(self, comm: Any) -> None:
        super().__init__()
        self.comm, self.rank, self.size = comm, comm.Get_rank(), comm.Get_size()

    def all_well(self, well: bool) -> bool:
        """See `Communicator.all_well`."""
        sick, total = np.array([not well], np.int32), np.empty(1, np.int32)
        self.comm.Allreduce(sick, total)
        return int(total[0]) == 0

    def swap(self, messages: Sequence[Bytes]) -> list[Bytes]:
        """See `Communicator.swap`."""
        counts = np.array([len(message) for message in messages], np.int32)
        incoming = np.empty(self.size, np.int32)
        self.comm.Alltoall(counts, incoming)
        received = np.empty(int(incoming.sum(dtype=np.int64)), np.uint8)
        self.comm.Alltoallv(
            [np.concatenate(messages), (counts, _starts(counts))], [received, (incoming, _starts(incoming))]
        )
        return np.split(received, np.cumsum(incoming)[:-1])

    def share(self, message: Bytes) -> list[Bytes]:
        """See `Communicator.share`."""
        incoming = np.empty(self.size, np.int32)
        self.comm.Allgather(np.array([len(message)], np.int32), incoming)
        received = np.empty(int(incoming.sum(dtype=np.int64)), np.uint8)
        self.comm.Allgatherv(np.ascontiguousarray(message), [received, (incoming, _starts(incoming))])
        return np.split(received, np.cumsum(incoming)[:-1])


def _starts(counts: NDArray[np.int32]) -> NDArray[np.int32]:
    return (np.cumsum(counts) - counts).astype(np.int32)
