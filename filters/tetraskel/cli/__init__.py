"""The command line: `tetraskel COMMAND IN OUT`, one file per sub-command."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from tetraskel import __version__
from tetraskel.cli import (
    bezier,
    compare,
    completion,
    measure,
    plugin_path,
    raster,
    skeleton,
    surface,
    thin,
    tree,
    view,
    voronoi,
)
from tetraskel.cli.outputs import Written, check_apart, inputs_of, outputs_of
from tetraskel.cli.several import jobs
from tetraskel.cli.usage import BAD_USAGE, HelpForm, Parser, given, shorten, told
from tetraskel.errors import TetraskelError

COMMANDS = {
    "skeleton": skeleton,
    "tree": tree,
    "voronoi": voronoi,
    "raster": raster,
    "thin": thin,
    "surface": surface,
    "bezier": bezier,
    "compare": compare,
    "measure": measure,
    "view": view,
    "plugin-path": plugin_path,
    "completion": completion,
}
INTERRUPTED = 130
DESCRIPTION = """Skeletons of points, found without normals, seeds or a length to tune.

First steps, with any file of points:

  tetraskel skeleton scan.ply skeleton.vtp --html skeleton.html
  tetraskel view skeleton.vtp --points scan.ply"""
EPILOG = """`tetraskel COMMAND --help` tells a command's options, with examples. The status is 0, or 2 with one
line that says what was expected, what came and what to do."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; 0 on success, 2 and one line on standard error for bad usage or bad input."""
    known = parser()
    chosen = known.parse_args(arguments)
    chosen.given = given(known, arguments)
    status = 0
    try:
        calls = jobs(chosen)
        written = Written(calls)
        for job in calls:
            status = max(status, _run(job, written))
            if status == INTERRUPTED:
                break
    except TetraskelError as error:
        return _failed(chosen, error)
    return status


def _run(chosen: argparse.Namespace, written: Written) -> int:
    try:
        check_apart(outputs_of(chosen), inputs_of(chosen))
        COMMANDS[chosen.command].run(chosen)
        sys.stdout.flush()
    except BrokenPipeError:  # who read our output has enough
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115  (closed with the program)
    except (TetraskelError, OSError) as error:
        return _failed(chosen, error)
    except KeyboardInterrupt:
        print(f"tetraskel {chosen.command}: stopped; {written.told()}.", file=sys.stderr)
        return INTERRUPTED
    return 0


def _failed(chosen: argparse.Namespace, error: Exception) -> int:
    print(f"tetraskel {chosen.command}: {_one_line(error)}", file=sys.stderr)
    return BAD_USAGE


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = Parser(prog="tetraskel", description=DESCRIPTION, epilog=EPILOG, formatter_class=HelpForm)
    top.add_argument("--version", action="version", version=f"tetraskel {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for name, module in COMMANDS.items():
        summary = module.__doc__.splitlines()[0]
        texts = {"help": summary, "description": module.__doc__, "epilog": told(module.EXAMPLES)}
        command = commands.add_parser(name, **texts, formatter_class=HelpForm)
        module.add_arguments(command)
        shorten(command)
    return top


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
