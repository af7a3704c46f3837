"""Pictures and pages of a result, for every command that has --png and --html."""

from __future__ import annotations

import argparse
from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.files import check_output, replace_file

SUFFIXES = {"png": (".png",), "html": (".html", ".htm")}


def check_drawings(chosen: argparse.Namespace) -> None:
    """Raise `InputError` when a drawing could not be written, before any work is done."""
    for kind, suffixes in SUFFIXES.items():
        if getattr(chosen, kind):
            check_output(getattr(chosen, kind), suffixes)


def draw_all(chosen: argparse.Namespace, source: vtkPointSet, result: vtkPolyData) -> None:
    """Draw `result` among the points of `source`, in each way that is asked for."""
    if chosen.png:
        from tetraskel.cli.picture import draw

        draw(source, result, chosen.png)
    if chosen.html:
        from tetraskel.cli.page import write_page

        title = Path(chosen.input).name
        replace_file(Path(chosen.html), lambda part: write_page(result, source, part, title))
