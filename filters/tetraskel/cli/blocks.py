"""`tetraskel skeleton --blocks`: points larger than memory, one block after another."""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from pathlib import Path

from tetraskel.cli.arguments import values
from tetraskel.cli.chain import prepared, summary_of, tell_counts
from tetraskel.cli.drawings import draw_all
from tetraskel.cli.files import expect_points, read, replace_file
from tetraskel.distributed.blockwise import (
    INSIDES,
    POINTS_PER_BLOCK,
    BlockOptions,
    blocks_for,
    skeleton_in_blocks,
)
from tetraskel.errors import InputError, InsideWarning
from tetraskel.options import DelaunayOptions, FlatOptions, InteriorOptions, SkeletonOptions, TreeOptions

AS_MANY_AS_NEEDED = 0
CURVE_BYTES = 2200  # of the process for each point of the curve skeleton (docs/speed.md)
HELP = (
    f"tree: work through the points in N blocks (no N: of {POINTS_PER_BLOCK:,} points), with what they hold in files "
    "beside OUT instead of memory; the same result, slower; with --inside all or gates"
)


def add_blocks(parser: argparse.ArgumentParser) -> None:
    """--blocks [N]."""
    parser.add_argument("--blocks", metavar="N", nargs="?", type=int, const=AS_MANY_AS_NEEDED, help=HELP)


def run_in_blocks(chosen: argparse.Namespace, extras: dict) -> None:
    """Make and write the tree's skeleton, block after block; drawings and tables, if asked for, read it whole.

    Raises
    ------
    InputError
        For what needs all points in memory at once.
    """
    from tetraskel.cli.pieces import mapped_points
    from tetraskel.cli.vtp_stream import write_vtp
    from tetraskel.vtkfilters.progress import ProgressLine

    _expect_possible(chosen)
    prepared(chosen)
    folder = Path(chosen.output).resolve().parent
    points = mapped_points(chosen.input, folder, points_only=chosen.points_only)
    expect_points(len(points), chosen.input)
    n_blocks = chosen.blocks or blocks_for(len(points))
    with ProgressLine() as line, warnings.catch_warnings():
        warnings.simplefilter("ignore", InsideWarning)  # said below, as without blocks
        whole = skeleton_in_blocks(
            points, folder, n_blocks, _options(chosen), lambda share: line.show("Block by block", share)
        )
    for message in whole.messages:
        print(f"warning: InteriorCells: {message}", file=sys.stderr)
    facts = {**whole.facts, "OriginalPointIds": whole.original_ids}
    removed = facts.pop("FlatRemoved")
    replace_file(Path(chosen.output), lambda part: write_vtp(part, whole, {**facts, "FlatRemoved": removed}))
    counts = {
        "input_points": len(points),
        "points": len(whole.points),
        "lines": len(whole.lengths),
        "faces": 0,
    }
    singles = {
        name: value for name, value in whole.facts.items() if not isinstance(value, float) or math.isfinite(value)
    }
    if extras or chosen.png or chosen.html:
        skeleton = read(chosen.output)
        for write in extras.values():
            write(skeleton)
        if chosen.png or chosen.html:
            draw_all(chosen, read(chosen.input), skeleton)
    tell_counts(chosen, counts, singles, summary_of(chosen, counts, int(whole.facts["DuplicatesMerged"])))


def _options(chosen: argparse.Namespace) -> BlockOptions:
    """What the call asks of the skeleton."""
    given = {name: value for one in STAGES for name, value in values(chosen, one).items()}
    del given["traversal"]  # breadth
    return BlockOptions(inside=given.pop("method"), **given)


STAGES = (InteriorOptions, TreeOptions, FlatOptions, SkeletonOptions)


def _expect_possible(chosen: argparse.Namespace) -> None:
    """Raise `InputError` for a call whose work cannot be done in blocks."""
    if chosen.method != "tree":
        raise InputError(
            "expected --method tree with --blocks, got the curve skeleton: it needs the whole cloud in memory, some "
            f"{CURVE_BYTES:,} bytes for each point; thin the points first (tetraskel thin), use --method tree "
            "--blocks, or leave out --blocks."
        )
    if chosen.input == "-" and (chosen.png or chosen.html):
        raise InputError("expected a file of points for --png and --html with --blocks, got standard input; save it.")
    if chosen.blocks < 0:
        raise InputError(f"expected --blocks with the number of blocks, got {chosen.blocks}; leave the number out.")
    if Path(chosen.output).suffix.lower() != ".vtp":
        raise InputError(f"expected an output file ending in .vtp with --blocks, got {chosen.output!r}.")
    if chosen.inside not in INSIDES:
        raise InputError(
            f"expected --inside {' or '.join(INSIDES)} with --blocks, got {chosen.inside}: that needs all points at "
            "once."
        )
    unlike = {
        "--traversal": (chosen.traversal, "breadth"),
        "--joggle": (chosen.joggle, DelaunayOptions.joggle),
        "--denoise": (chosen.denoise, False),
    }
    for flag, (value, needed) in unlike.items():
        if value != needed:
            raise InputError(f"expected {flag} {needed} with --blocks, got {value}: that needs all points at once.")
    if chosen.engine not in ("auto", "exact"):
        raise InputError(f"expected --engine exact with --blocks, got {chosen.engine}: others cannot work in blocks.")
