"""Points or a mesh to a skeleton: the curve skeleton of the object, or the skeleton of the paper's tree.

The curve skeleton (--method curve) finds the object's inside from the points alone and draws lines along its middle,
with radii and with the object's own loops. The tree (--method tree) is the paper's chain: triangulate, walk the
simplices, remove flat ones, leave out the leaves. Unless --inside and --denoise say otherwise, the curve looks for the
inside by gates and takes noise out, the tree takes all simplices of the points as they are.
"""

from __future__ import annotations

import argparse
import sys

from tetraskel.cli.arguments import add_options, names_of, refuse, values
from tetraskel.cli.outputs import OutputFile
from tetraskel.errors import InputError, NoInsideError
from tetraskel.options import CurveOptions, DelaunayOptions, FlatOptions, SkeletonOptions, TreeOptions

PORTS = {"points": 1, "sheets": 2}  # of the filter; all else is made from the skeleton
CURVE_ONLY = {
    "points": "a tree's nodes are no parts of a surface",
    "sheets": "a tree has none",
}
EXAMPLES = (
    (
        "The curve skeleton of a scan, and a page that turns it in a browser:",
        "skeleton scan.ply skeleton.vtp --html skeleton.html",
    ),
    (
        "Main lines only, for programs that read neurons and vessels, with a table of the branches:",
        "skeleton scan.ply lines.swc --detail 0.2 --table branches.csv",
    ),
    (
        "The paper's tree of the triangulation instead, flat tetrahedra removed:",
        "skeleton cloud.csv tree.vtp --method tree --threshold 0.05",
    ),
    ("The same of points that do not fit in memory:", "skeleton big.npy tree.vtp --method tree --blocks"),
    (
        "The tree of the inside of a surface, of points that do not fit either:",
        "skeleton scan.npy tree.vtp --method tree --inside gates --blocks",
    ),
    ("Every file of a folder, each with its own result:", "skeleton scans/*.ply skeletons/"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel skeleton` takes."""
    from tetraskel.cli.blocks import add_blocks
    from tetraskel.cli.chain import add_files, add_inside

    add_files(parser)
    parser.add_argument("--method", choices=("curve", "tree"), default="curve", help="which skeleton")
    parser.add_argument(
        "--edges", metavar="FILE", type=OutputFile, help="also write the edges as .csv, by rows of the table of nodes"
    )
    parser.add_argument("--table", metavar="FILE", type=OutputFile, help="also write a row per branch as .csv")
    parser.add_argument(
        "--points", metavar="FILE", type=OutputFile, help="curve: also write the points with their branch as .vtp"
    )
    parser.add_argument(
        "--sheets", metavar="FILE", type=OutputFile, help="curve: also write the medial sheets as .vtp or .vtk"
    )
    add_blocks(parser)
    add_inside(parser)
    add_options(parser, CurveOptions, DelaunayOptions, TreeOptions, FlatOptions, SkeletonOptions)
    parser.set_defaults(inside=None, denoise=None)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the skeleton."""
    from tetraskel.cli.chain import inside_options

    if chosen.inside is None:
        chosen.inside = "gates" if chosen.method == "curve" else "all"
    if chosen.denoise is None:
        chosen.denoise = CurveOptions.denoise if chosen.method == "curve" else DelaunayOptions.denoise
    for options in (CurveOptions, DelaunayOptions, TreeOptions, FlatOptions, SkeletonOptions):
        values(chosen, options)  # a wrong value is told, whether this method uses it or not
    inside_options(chosen)
    _expect_of_use(chosen)
    extras = _extra_writers(chosen)
    if chosen.blocks is not None:
        from tetraskel.cli.blocks import run_in_blocks

        run_in_blocks(chosen, extras)
    elif chosen.method == "tree":
        _tree(chosen, extras)
    else:
        _curve(chosen, extras)


def _expect_of_use(chosen: argparse.Namespace) -> None:
    """Raise `InputError` for options of the other method, and for one of sheets that are not asked for."""
    if chosen.method == "tree":
        shared = names_of(DelaunayOptions)
        curve = [name for name in names_of(CurveOptions) if name not in shared]
        refuse(chosen, curve, "--method curve", "--method tree")
    else:
        refuse(chosen, names_of(TreeOptions, FlatOptions, SkeletonOptions), "--method tree", "--method curve")
        if not chosen.sheets:
            refuse(chosen, ["sheet_angle"], "--sheets", "none")


def _extra_writers(chosen: argparse.Namespace) -> dict:
    """Writers of the files asked for beside the skeleton, checked before any work."""
    from tetraskel.cli.files import check_output, replace_to, write_by_suffix
    from tetraskel.cli.graph_formats import write_branch_table, write_edges_csv

    for name, reason in CURVE_ONLY.items():
        if getattr(chosen, name) and chosen.method == "tree":
            raise InputError(f"expected --{name} with --method curve only; {reason}.")
    tables, meshes = (".csv",), (".vtp", ".vtk")
    wanted = {
        "edges": (chosen.edges, tables, write_edges_csv),
        "table": (chosen.table, tables, write_branch_table),
        "points": (chosen.points, meshes[:1], write_by_suffix),
        "sheets": (chosen.sheets, meshes, _write_sheets),
    }
    for path, suffixes, _ in wanted.values():
        if path:
            check_output(path, suffixes)
    return {name: replace_to(path, write) for name, (path, _, write) in wanted.items() if path}


def _write_sheets(sheets, path) -> None:
    """Write the sheets; where there are none, say so."""
    from tetraskel.cli.files import write_by_suffix

    write_by_suffix(sheets, path)
    if not sheets.GetNumberOfPolys():
        print("warning: no part of the object has medial sheets; the file of --sheets has 0 faces.", file=sys.stderr)


def _tree(chosen: argparse.Namespace, extras: dict) -> None:
    from tetraskel.cli.chain import interior_cells, run_chain
    from tetraskel.vtkfilters import DelaunayMesh, FlatTetraRemoval, SkeletonOutput, TreeBuilder

    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    tree = TreeBuilder(**values(chosen, TreeOptions))
    flat = FlatTetraRemoval(**values(chosen, FlatOptions))
    drawn = SkeletonOutput(**values(chosen, SkeletonOptions))
    run_chain(chosen, [mesh, *interior_cells(chosen, extract=True), tree, flat, drawn])
    for write in extras.values():
        write(drawn.GetOutputDataObject(0))


def _curve(chosen: argparse.Namespace, extras: dict) -> None:
    from tetraskel.cli.chain import interior_cells, run_chain
    from tetraskel.vtkfilters import CurveSkeleton, DelaunayMesh, InteriorCells

    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    curve = CurveSkeleton(**values(chosen, CurveOptions), sheets=chosen.sheets is not None)
    inside = interior_cells(chosen, extract=False) or [InteriorCells(method="all")]  # or the curve would look for it
    try:
        run_chain(chosen, [mesh, *inside, curve])
    except NoInsideError as error:
        raise InputError(_without_inside(str(error), chosen.inside)) from error
    for name, write in extras.items():
        write(curve.GetOutputDataObject(PORTS.get(name, 0)))


def _without_inside(told: str, inside: str) -> str:
    """What was told of an object without an inside, and the options that may help."""
    found, others = told.split(";")[0], {"--inside all": "take all of it as inside", "--method tree": "draw the tree"}
    others.pop(f"--inside {inside}", None)
    return f"{found}; use " + ", or ".join(f"{flag} to {meaning}" for flag, meaning in others.items()) + "."
