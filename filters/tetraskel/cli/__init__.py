"""The command line: `tetraskel COMMAND IN OUT`, one file per sub-command."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from tetraskel import __version__
from tetraskel.cli import bezier, compare, measure, plugin_path, raster, skeleton, surface, tree, voronoi
from tetraskel.cli.several import jobs
from tetraskel.errors import TetraskelError

COMMANDS = {
    "tree": tree,
    "skeleton": skeleton,
    "voronoi": voronoi,
    "raster": raster,
    "surface": surface,
    "bezier": bezier,
    "compare": compare,
    "measure": measure,
    "plugin-path": plugin_path,
}
BAD_USAGE, INTERRUPTED = 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; 0 on success, 2 and one line on standard error for bad usage or bad input."""
    chosen = parser().parse_args(arguments)
    status = 0
    try:
        for job in jobs(chosen):
            status = max(status, _run(job))
            if status == INTERRUPTED:
                break
    except TetraskelError as error:
        return _failed(chosen, error)
    return status


def _run(chosen: argparse.Namespace) -> int:
    try:
        COMMANDS[chosen.command].run(chosen)
        sys.stdout.flush()
    except BrokenPipeError:  # who read our output has enough
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115  (closed with the program)
    except (TetraskelError, OSError) as error:
        return _failed(chosen, error)
    except KeyboardInterrupt:
        print(f"tetraskel {chosen.command}: stopped; nothing was written.", file=sys.stderr)
        return INTERRUPTED
    return 0


def _failed(chosen: argparse.Namespace, error: Exception) -> int:
    print(f"tetraskel {chosen.command}: {_one_line(error)}", file=sys.stderr)
    return BAD_USAGE


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = Parser(prog="tetraskel", description="Skeletons of point sets by trees over their Delaunay triangulation.")
    top.add_argument("--version", action="version", version=f"tetraskel {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for name, module in COMMANDS.items():
        summary = module.__doc__.splitlines()[0]
        form = argparse.ArgumentDefaultsHelpFormatter
        module.add_arguments(commands.add_parser(name, help=summary, description=module.__doc__, formatter_class=form))
    return top


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage text."""

    def error(self, message: str) -> None:
        """Print one line and leave with status 2."""
        self.exit(BAD_USAGE, f"{self.prog}: {message} (see {self.prog} --help).\n")


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
