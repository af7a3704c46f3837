"""What `tetraskel compare` writes: its folder, tables and skeletons."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from tetraskel.cli.comparison_pictures import draw_each, draw_overview
from tetraskel.cli.files import check_output, replace_file, write_by_suffix
from tetraskel.cli.outputs import check_apart
from tetraskel.comparison import Row
from tetraskel.errors import InputError
from tetraskel.kernels.drawn_measures import MEASURES
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.object_boundary import boundary_of, object_numbers
from tetraskel.vtkfilters.drawn_data import data_of_boundary, data_of_drawn

TABLES = ("table.md", "table.json", "overview.png")
UNITS = {"reconstruction_mean": " [% of D]", "reconstruction_max": " [% of D]"}
DIGITS = 4


@dataclass(frozen=True)
class Judged:
    """The object that was compared, and the file of the surface it was judged by, if one was given."""

    source: str
    surface: str | None
    mesh: Triangulation
    inside: np.ndarray

    @cached_property
    def boundary(self):
        """The boundary of the inside."""
        return boundary_of(self.mesh, self.inside)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Components and Euler characteristic of the object."""
        return object_numbers(self.mesh, self.inside)

    @property
    def judged_by(self) -> str:
        """What the skeletons are judged by, in words."""
        if self.surface:
            return f"the surface {self.surface}"
        kind = "triangles" if self.mesh.dim == 3 else "segments"
        return f"the boundary of the object's inside, found from the points ({len(self.boundary.facets):,} {kind})"


def checked_folder(path: str, methods: Sequence[str], inputs: Sequence[str]) -> Path:
    """The folder to write into, after all that can be wrong with it has been looked at; nothing is made yet.

    Raises
    ------
    InputError
        When it is a file, cannot be made or written into, or a file in it would replace an input.
    """
    folder = Path(path)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"expected a folder to write into, got {path!r}, which is a file.")
    above = folder if folder.exists() else folder.resolve().parent
    if not above.is_dir():
        raise InputError(f"expected a place for the folder {path!r}, got {str(above)!r}, which does not exist.")
    if not os.access(above, os.W_OK):
        raise InputError(f"expected a folder to write into, got {path!r}, which is read-only.")
    files = [folder / name for name in (*TABLES, *(name + end for name in methods for end in (".png", ".vtp")))]
    check_apart([str(file) for file in files], inputs)
    if folder.exists():
        for file in files:
            check_output(str(file), (file.suffix,))
    return folder


def write_all(folder: Path, rows: Sequence[Row], judged: Judged) -> None:
    """Tables, skeletons, a picture of each, and one of all."""
    folder.mkdir(exist_ok=True)
    skeletons = {row.method: data_of_drawn(row.drawn) for row in rows if row.drawn is not None}
    for name, data in skeletons.items():
        replace_file(folder / f"{name}.vtp", lambda part, data=data: write_by_suffix(data, part))
    boundary = data_of_boundary(judged.boundary, judged.mesh.points)
    draw_each(folder, rows, skeletons, boundary)
    draw_overview(folder / "overview.png", rows, skeletons, boundary)
    replace_file(folder / "table.md", lambda part: part.write_text(markdown(rows, judged), encoding="utf-8"))
    as_json = json.dumps(found(rows, judged), indent=2) + "\n"
    replace_file(folder / "table.json", lambda part: part.write_text(as_json, encoding="utf-8"))


def markdown(rows: Sequence[Row], judged: Judged) -> str:
    """The table, a row for each method, with what it is judged by above it."""
    head = ["method", "drawn as", *(name.replace("_", " ") + UNITS.get(name, "") for name in MEASURES), "seconds"]
    table = [head, ["---"] * len(head)]
    for row in rows:
        numbers = [_number(row.measures[name]) for name in MEASURES]
        kind = f"failed: {row.failure}".replace("|", "/") if row.failure else row.kind
        table.append([row.method, kind, *numbers, "-" if row.failure else f"{row.seconds:.2f}"])
    numbers = judged.numbers
    return (
        f"# Skeletons of {judged.source}\n\n"
        f"{len(judged.mesh.points):,} points, {int(np.count_nonzero(judged.inside)):,} of {len(judged.mesh):,} cells "
        f"inside; the object has components: {numbers['components']}, Euler characteristic: {numbers['euler']}.\n"
        f"Judged by {judged.judged_by}.\n\n" + "\n".join(f"| {' | '.join(cells)} |" for cells in table) + "\n"
    )


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int) else f"{value:.{DIGITS}g}"


def found(rows: Sequence[Row], judged: Judged) -> dict:
    """The same for JSON: None where a measure has no meaning."""
    measured = [
        {
            "method": row.method,
            "kind": row.kind or None,
            **row.measures,
            "seconds": None if row.failure else row.seconds,
            "failure": row.failure or None,
        }
        for row in rows
    ]
    about = {"input": judged.source, "judged_by": rows[0].judged_by, "surface": judged.surface}
    return {**about, "object": judged.numbers, "rows": measured}
