"""Which words of a call name files, and that no output is written over an input."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from tetraskel.errors import InputError

STANDARD_INPUT = "-"


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
