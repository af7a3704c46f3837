"""Several inputs in one call: a result for each, in a folder."""

from __future__ import annotations

import argparse
import copy
from pathlib import Path

from tetraskel.cli.outputs import STANDARD_INPUT, OutputFile
from tetraskel.errors import InputError

SUFFIX = ".vtp"
ONE_FILE = ("png", "html", "edges", "table", "points", "sheets", "pieces")  # options that name a file for one result


def jobs(chosen: argparse.Namespace) -> list[argparse.Namespace]:
    """What to run: the call itself, or one for each input, with its result in the folder OUT.

    Raises
    ------
    InputError
        When OUT is no folder, two results would have one name, or a file is named for one result.
    """
    inputs = getattr(chosen, "input", None)
    if not isinstance(inputs, list):
        return [chosen]
    if len(inputs) == 1:
        chosen.input = inputs[0]
        return [chosen]
    _check(chosen, inputs)
    return [_job(chosen, path) for path in inputs]


def _check(chosen: argparse.Namespace, inputs: list[str]) -> None:
    if not Path(chosen.output).is_dir():
        raise InputError(f"expected a folder for the results of {len(inputs)} inputs, got {chosen.output!r}; make it.")
    if STANDARD_INPUT in inputs:
        raise InputError("expected files only where there are several inputs, got standard input (-) among them.")
    named = [name for name in ONE_FILE if getattr(chosen, name, None)]
    if named:
        raise InputError(f"expected one input with --{named[0]}, got {len(inputs)}; its file would hold the last only.")
    stems = [Path(path).stem for path in inputs]
    twice = [stem for k, stem in enumerate(stems) if stem in stems[:k]]
    if twice:
        raise InputError(f"expected inputs of different names, got two that would both give {twice[0] + SUFFIX!r}.")


def _job(chosen: argparse.Namespace, path: str) -> argparse.Namespace:
    job = copy.copy(chosen)
    job.input, job.output = path, OutputFile(Path(chosen.output) / (Path(path).stem + SUFFIX))
    job.all_inputs = chosen.input  # none of them is to be written over
    return job
