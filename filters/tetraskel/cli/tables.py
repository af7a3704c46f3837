"""Tables of coordinates: which separator, which columns, which rows."""

from __future__ import annotations

import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np

from tetraskel.errors import InputError

# Names of the coordinates in a header, without quotes and units, in small letters; ParaView writes the second kind.
NAMED_AXES = (("x", "y", "z"), ("points:0", "points:1", "points:2"), ("points_0", "points_1", "points_2"))
SEPARATORS = (";", ",", "\t")
NUMBER = re.compile(r"[+-]?\d+([.,]\d+)?([eE][+-]?\d+)?")  # with a decimal point or comma


def read_table(file: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Coordinates (n, 2) or (n, 3) of a table, and its other columns of numbers by name.

    Raises
    ------
    InputError
        For a file that is not a table of numbers, or whose coordinates cannot be told from the rest.
    """
    return _from_npy(file) if file.suffix.lower() == ".npy" else _from_text(file)


def _from_npy(file: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    return np.array(open_npy(file)), {}


def open_npy(file: Path) -> np.ndarray:
    """The points of an array file, mapped: they are read where they are looked at.

    Raises
    ------
    InputError
        For another kind of file or array.
    """
    try:
        table = np.load(
            file, mmap_mode="r", allow_pickle=False
        )  # a mapping is no longer than the file, whatever it says
    except (ValueError, EOFError, OSError, OverflowError, SyntaxError, tokenize.TokenError) as error:
        raise InputError(f"{str(file)!r} is not a plain array file, or holds less than its header says.") from error
    if table.ndim != 2 or table.shape[1] not in (2, 3) or table.dtype.kind not in "fiub":
        raise InputError(
            f"expected numbers of shape (n, 2) or (n, 3) in {str(file)!r}, got {table.dtype} {table.shape}."
        )
    return table


def _from_text(file: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    return _from_bytes(file.read_bytes(), file)


def read_standard_input() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """A table of text from standard input; see `read_table`."""
    return _from_bytes(sys.stdin.buffer.read(), Path("standard input"))


def _from_bytes(content: bytes, file: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Rows of cells; `#` begins a comment, and a first row that is not all numbers is a header."""
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"expected a text file in UTF-8, got {str(file)!r} in another encoding.") from error
    numbered = [(k, line.split("#")[0].strip()) for k, line in enumerate(lines, 1)]
    rows = [(k, line) for k, line in numbered if line]
    if not rows:
        return np.empty((0, 3)), {}
    separator = next((mark for mark in SEPARATORS if mark in rows[0][1]), None)
    cells = [(k, [cell.strip().strip('"') for cell in line.split(separator)]) for k, line in rows]
    header = cells.pop(0)[1] if _is_header(file, *cells[0]) else []
    columns = _coordinate_columns(header or [""] * len(cells[0][1]), file)
    width = len(header or cells[0][1])
    coordinates = np.array([_numbers(file, k, row, columns, width) for k, row in cells]).reshape(-1, len(columns))
    return coordinates, _other_columns(header, columns, [row for _, row in cells])


def rows_of_table(stream: IO[bytes], file: Path, length: int) -> Iterator[np.ndarray]:
    """The coordinates of a table, at most `length` rows at a time; other columns are left out.

    Raises
    ------
    InputError
        As `read_table`; what is wrong is told by its line.
    """
    separator, columns, width = None, None, 0
    piece: list[list[float]] = []
    for k, line in _lines(stream, file):
        if columns is None:
            separator = next((mark for mark in SEPARATORS if mark in line), None)
        cells = [cell.strip().strip('"') for cell in line.split(separator)]
        if columns is None:
            header = _is_header(file, k, cells)
            columns, width = _coordinate_columns(cells if header else [""] * len(cells), file), len(cells)
            if header:
                continue
        piece.append(_numbers(file, k, cells, columns, width))
        if len(piece) == length:
            yield np.array(piece)
            piece = []
    if piece:
        yield np.array(piece)


def _lines(stream: IO[bytes], file: Path) -> Iterator[tuple[int, str]]:
    """Lines with something in them, and their numbers, without comments."""
    for k, line in enumerate(stream, 1):
        try:
            text = line.decode("utf-8-sig" if k == 1 else "utf-8").split("#")[0].strip()
        except UnicodeDecodeError as error:
            raise InputError(f"expected a text file in UTF-8, got {str(file)!r} in another encoding.") from error
        if text:
            yield k, text


def _coordinate_columns(header: list[str], file: Path) -> list[int]:
    """Where the coordinates are: by name, or the first two or three columns of a table that has no others."""
    names = [re.sub(r"\s*[\[(].*", "", name).strip().lower() for name in header]
    for axes in NAMED_AXES:
        found = [names.index(axis) for axis in axes if axis in names]
        if len(found) >= 2 and axes[0] in names and axes[1] in names:
            return found
    if len(header) in (2, 3):
        return list(range(len(header)))
    raise InputError(
        f"expected two or three columns of coordinates in {str(file)!r}, or a header that names x, y and z, "
        f"got {len(header)} columns" + (f" named {', '.join(header)}." if any(header) else ".")
    )


def _numbers(file: Path, line: int, row: list[str], columns: list[int], width: int) -> list[float]:
    if len(row) != width:
        _expect_decimal_points(file, line, row)
        raise InputError(f"expected {width} cells in each line of {str(file)!r}, got {len(row)} in line {line}.")
    try:
        return [float(row[column]) for column in columns]
    except ValueError as error:
        _expect_decimal_points(file, line, row)
        words = next(row[column] for column in columns if not _is_number(row[column]))
        raise InputError(f"expected numbers in line {line} of {str(file)!r}, got {words!r}.") from error


def _is_header(file: Path, line: int, row: list[str]) -> bool:
    """Whether the first row names columns; it does not when it is numbers with decimal commas."""
    _expect_decimal_points(file, line, row)
    return not all(map(_is_number, row))


def _expect_decimal_points(file: Path, line: int, row: list[str]) -> None:
    """Raise `InputError` when the cells, or what a comma split into cells, are numbers with decimal commas."""
    for mark in (" ", ","):
        words = mark.join(row).split()
        commas = [word for word in words if "," in word]
        if len(words) > 1 and commas and all(map(NUMBER.fullmatch, words)):
            raise InputError(
                f"expected numbers with decimal points in line {line} of {str(file)!r}, got {commas[0]!r}; write "
                f"{commas[0].replace(',', '.')!r}."
            )


def _other_columns(header: list[str], columns: list[int], rows: list[list[str]]) -> dict[str, np.ndarray]:
    """Named columns that hold numbers only; columns of words are left out."""
    others = {}
    for k, name in enumerate(header):
        if k not in columns and name and all(_is_number(row[k]) for row in rows):
            others[name] = np.array([float(row[k]) for row in rows])
    return others


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
