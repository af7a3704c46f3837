"""Arrays kept in files instead of memory, and used as if they were there.

An array on the shelf is a mapping of a file without a name: the system reads what is looked at, and takes it back when
it needs the room. The file goes with the last array that uses it, or with the process, however that ends.
"""

from __future__ import annotations

import mmap
import tempfile
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from tetraskel.errors import InputError

Array = NDArray[Any]

SMALL = 1 << 16  # bytes; less stays in memory
ALIGNED = 64  # bytes
PIECE = 1 << 20  # bytes written at a time


class Shelf:
    """Room for arrays in files of one folder.

    Parameters
    ----------
    folder : path
        On a disk with room: a folder that is itself kept in memory defeats the purpose.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._maps: weakref.WeakSet[mmap.mmap] = weakref.WeakSet()

    def put(self, *arrays: Array) -> list[Array]:
        """The same arrays, in one file; they can be written to. Small ones stay as they are.

        Raises
        ------
        InputError
            When the disk is full, or the system refuses another file or mapping.
        """
        if sum(array.nbytes for array in arrays) < SMALL:
            return list(arrays)
        starts = _starts(array.nbytes for array in arrays)
        with self._file() as file:
            _write(file, arrays, starts)
            return self._mapped(file, [(array.shape, array.dtype) for array in arrays], starts)

    def room(self, *kinds: tuple[tuple[int, ...], DTypeLike]) -> list[Array]:
        """Arrays of these shapes and types, zero everywhere, in one file.

        Raises
        ------
        InputError
            When the disk is full, or the system refuses another file or mapping.
        """
        exact = [(shape, np.dtype(kind)) for shape, kind in kinds]
        starts = _starts(int(np.prod(shape, dtype=np.int64)) * kind.itemsize for shape, kind in exact)
        with self._file() as file:
            _zeros(file, starts[-1])  # a hole would fail when it is written to, with a crash
            return self._mapped(file, exact, starts)

    def leave(self) -> None:
        """Give back the memory of all arrays; what is looked at next is read again."""
        if hasattr(mmap, "MADV_DONTNEED"):
            for mapped in list(self._maps):
                mapped.madvise(mmap.MADV_DONTNEED)

    @contextmanager
    def _file(self) -> Iterator[IO[bytes]]:
        try:
            with tempfile.TemporaryFile(dir=self.folder, prefix=".tetraskel-") as file:
                yield file
        except OSError as error:
            raise InputError(
                f"expected room for the blocks in {str(self.folder)!r}, got: {error.strerror}; make room for it there."
            ) from error

    def _mapped(self, file: IO[bytes], kinds: Sequence[tuple[tuple[int, ...], Any]], starts: list[int]) -> list[Array]:
        if starts[-1] == 0:
            return [np.zeros(shape, kind) for shape, kind in kinds]
        file.flush()
        mapped = mmap.mmap(file.fileno(), starts[-1])
        self._maps.add(mapped)
        counts = [int(np.prod(shape, dtype=np.int64)) for shape, _ in kinds]
        return [
            np.frombuffer(mapped, kind, count, start).reshape(shape)
            for (shape, kind), count, start in zip(kinds, counts, starts, strict=False)
        ]


def _starts(sizes: Any) -> list[int]:
    """Where each of the arrays begins in the file, and its length."""
    starts = [0]
    for size in sizes:
        starts.append(starts[-1] + -(-size // ALIGNED) * ALIGNED)
    return starts


def _write(file: IO[bytes], arrays: Sequence[Array], starts: list[int]) -> None:
    for array, start, stop in zip(arrays, starts[:-1], starts[1:], strict=True):
        rows = max(PIECE // max(array.nbytes // max(len(array), 1), 1), 1)
        for row in range(0, len(array), rows):
            file.write(np.ascontiguousarray(array[row : row + rows]).reshape(-1).view(np.uint8).data)
        file.write(bytes(stop - start - array.nbytes))


def _zeros(file: IO[bytes], size: int) -> None:
    nothing = bytes(PIECE)
    for start in range(0, size, PIECE):
        file.write(nothing[: min(PIECE, size - start)])
