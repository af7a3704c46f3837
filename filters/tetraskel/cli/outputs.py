"""Which words of a call name files, and that no output is written over an input."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from tetraskel.errors import InputError

STANDARD_INPUT = "-"
FEW = 3  # files named in a line


class InputFile(str):
    """A file to read; the type of every argument that names one."""


class OutputFile(str):
    """A file to write, or a folder to write into; the type of every argument that names one."""


def inputs_of(chosen: argparse.Namespace) -> list[str]:
    """All files a call reads."""
    return [path for path in _named(chosen, InputFile) if path != STANDARD_INPUT]


def outputs_of(chosen: argparse.Namespace) -> list[str]:
    """All files, or the folder, a call writes."""
    return _named(chosen, OutputFile)


def _named(chosen: argparse.Namespace, kind: type[str]) -> list[str]:
    given = [value if isinstance(value, list) else [value] for value in vars(chosen).values()]
    return [path for paths in given for path in paths if isinstance(path, kind)]


def check_apart(outputs: Sequence[str], inputs: Sequence[str]) -> None:
    """Raise `InputError` when an output would be written over an input, or two outputs into one file."""
    for k, path in enumerate(outputs):
        if any(_is_same(path, other) for other in inputs):
            raise InputError(f"expected an output beside the input, got {str(path)!r} for both.")
        if any(_is_same(path, other) for other in outputs[:k]):
            raise InputError(f"expected a file for each output, got {str(path)!r} for two.")


def _is_same(first: str, second: str) -> bool:
    a, b = Path(first), Path(second)
    return a.resolve() == b.resolve() or (a.exists() and b.exists() and a.samefile(b))


class Written:
    """Which of the outputs of some calls have been written since this was made."""

    def __init__(self, calls: Sequence[argparse.Namespace]) -> None:
        self._before = {path: _mark(path) for call in calls for path in outputs_of(call)}

    def told(self) -> str:
        """The end of a sentence about work that was stopped."""
        paths = [path for path, before in self._before.items() if _mark(path) != before]
        if not paths:
            return "nothing was written"
        more = f" and {len(paths) - FEW} more" if len(paths) > FEW else ""
        verb = "was" if len(paths) == 1 else "were"
        return f"{', '.join(map(str, paths[:FEW]))}{more} {verb} written before"


def _mark(path: str) -> dict[str, tuple[int, int]]:
    """What changes when a file, or one in a folder, is written: a file moved to its place is another one."""
    place = Path(path)
    files = place.iterdir() if place.is_dir() else [place] if place.exists() else []
    stats = {str(file): file.stat() for file in files}
    return {name: (stat.st_ino, stat.st_mtime_ns) for name, stat in stats.items()}
