"""A .vtp file written from arrays in files, a piece at a time: never more than a piece is in memory.

The format is VTK's own ("VTK XML formats", appended raw data with zlib blocks): the head names each array and where its
data begin; the data are a list of the lengths of compressed blocks, then the blocks.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import IO
from xml.sax.saxutils import quoteattr

import numpy as np

BLOCK = 1 << 20  # bytes before compression
LEVEL = 1  # of compression: the quickest
ROOM = 20  # digits of an offset
TYPES = {
    "float64": "Float64",
    "float32": "Float32",
    "int64": "Int64",
    "int32": "Int32",
    "uint8": "UInt8",
    "bool": "UInt8",
}

Facts = dict[str, "int | float | str | np.ndarray"]


class _Data:
    """Arrays named in the head, whose data come later."""

    def __init__(self, file: IO[bytes]) -> None:
        self.file = file
        self.named: list[tuple[np.ndarray, int]] = []  # and where its offset is to be written

    def say(self, text: str) -> None:
        self.file.write(text.encode())

    def name(self, array: np.ndarray, name: str, more: str = "") -> None:
        """Write the element of an array, with room for its offset."""
        width = array.shape[1] if array.ndim == 2 else 1
        kind = TYPES[array.dtype.name]
        self.say(f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{width}" {more}')
        self.say('format="appended" offset="')
        self.named.append((array, self.file.tell()))
        self.say(" " * ROOM + '"/>\n')

    def append(self) -> None:
        """Write the data of all arrays."""
        self.say('<AppendedData encoding="raw">\n_')
        start = self.file.tell()
        for array, place in self.named:
            offset = self.file.tell() - start
            self.file.seek(place)
            self.say(f'{offset}"'.ljust(ROOM + 1))
            self.file.seek(0, 2)
            _append_blocks(self.file, array)
        self.say("\n</AppendedData>\n")


def write_vtp(file: Path, skeleton, facts: Facts) -> None:
    """Write a `WholeSkeleton` as polygonal data, with these facts as its field data."""
    with open(file, "wb") as stream:
        data = _Data(stream)
        n_alone, n_lines = len(skeleton.alone), len(skeleton.lengths)
        order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
        data.say('<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" ')
        data.say(f'byte_order="{order}" header_type="UInt64" compressor="vtkZLibDataCompressor">\n<PolyData>\n')
        _name_facts(data, facts)
        data.say(f'<Piece NumberOfPoints="{len(skeleton.points)}" NumberOfVerts="{n_alone}" ')
        data.say(f'NumberOfLines="{n_lines}" NumberOfStrips="0" NumberOfPolys="0">\n<PointData Scalars="Depth">\n')
        for name, array in skeleton.nodes.items():
            data.name(array, name)
        data.say("</PointData>\n<CellData>\n")
        data.name(_branch_ids(n_alone, n_lines), "BranchId")
        lengths = np.concatenate([np.zeros(n_alone), skeleton.lengths]) if n_alone else skeleton.lengths
        data.name(lengths, "Length")
        data.say("</CellData>\n<Points>\n")
        data.name(skeleton.points, "Points")
        data.say("</Points>\n")
        _name_cells(data, "Verts", skeleton.alone, np.arange(1, n_alone + 1, dtype=np.int64))
        _name_cells(data, "Lines", skeleton.path, skeleton.offsets[1:])
        data.say("</Piece>\n</PolyData>\n")
        data.append()
        data.say("</VTKFile>\n")


def _branch_ids(n_alone: int, n_lines: int) -> np.ndarray:
    return np.arange(-n_alone, n_lines, dtype=np.int32).clip(-1)


def _name_cells(data: _Data, name: str, nodes: np.ndarray, ends: np.ndarray) -> None:
    data.say(f"<{name}>\n")
    data.name(nodes, "connectivity")
    data.name(ends, "offsets")
    data.say(f"</{name}>\n")


def _name_facts(data: _Data, facts: Facts) -> None:
    data.say("<FieldData>\n")
    for name, value in facts.items():
        if isinstance(value, str):
            codes = " ".join(str(code) for code in (*value.encode(), 0))
            data.say(f'<Array type="String" Name={quoteattr(name)} NumberOfTuples="1" format="ascii">{codes}</Array>\n')
        else:
            array = np.atleast_1d(value)
            data.name(array, name, f'NumberOfTuples="{len(array)}" ')
    data.say("</FieldData>\n")


def _append_blocks(file: IO[bytes], array: np.ndarray) -> None:
    """The number of blocks, their length and that of a shorter last one, the lengths when compressed, the blocks."""
    n_blocks = -(-array.nbytes // BLOCK)
    head = np.zeros(3 + n_blocks, np.uint64)
    head[:3] = n_blocks, BLOCK, array.nbytes % BLOCK
    start = file.tell()
    file.write(head.tobytes())
    for k, piece in enumerate(_pieces(array)):
        packed = zlib.compress(piece, LEVEL)
        head[3 + k] = len(packed)
        file.write(packed)
    file.seek(start)
    file.write(head.tobytes())
    file.seek(0, 2)


def _pieces(array: np.ndarray) -> Iterable[np.ndarray]:
    """The bytes of an array, a block at a time."""
    whole = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    for start in range(0, len(whole), BLOCK):
        yield whole[start : start + BLOCK]
