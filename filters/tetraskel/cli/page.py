"""A page that turns a result in any browser: one file, without a server, with the geometry inside it."""

from __future__ import annotations

import html
import json
from importlib import resources
from pathlib import Path

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.colours import DEPTH, RADIUS, colour_range
from tetraskel.errors import InputError
from tetraskel.vtkfilters.convert import array_of, points_of, segments_of, surface_of_data

LARGEST = 300_000  # points of a result that a browser still turns
CLOUD_POINTS = 60_000  # of the object, shown around it
STEPS = 65_535  # to which their places are rounded, along the longest side
THIN = 0.008  # of a line's tube at least, relative to half the diagonal
COLOURS = {"radius": RADIUS, "depth": DEPTH, "branch": "BranchId"}


def write_page(data: vtkPolyData, source: vtkPointSet, path: Path, title: str) -> None:
    """Write a page that shows `data` among the points of `source`.

    Raises
    ------
    InputError
        When there are more points than a browser turns.
    """
    if data.GetNumberOfPoints() > LARGEST:
        raise InputError(
            f"expected at most {LARGEST:,} points for a page, got {data.GetNumberOfPoints():,}; draw them with --png."
        )
    text = json.dumps(geometry(data, source, title), allow_nan=False, separators=(",", ":"))
    inside_script = text.replace("<", "\\u003c")  # nothing in it can end the script
    frame = resources.files("tetraskel.cli").joinpath("page.html").read_text(encoding="utf-8")
    head, rest = frame.split("{{title}}")
    middle, tail = rest.split("{{geometry}}")
    path.write_text("".join([head, html.escape(title), middle, inside_script, tail]), encoding="utf-8")


def geometry(data: vtkPolyData, source: vtkPointSet, title: str) -> dict:
    """What the page draws: points, edges and triangles as they are, and the source's points rounded.

    Points (n, 3) and radii are exact; values that are not finite are None.
    """
    arrays = {name: array_of(data.GetPointData(), array) for name, array in COLOURS.items()}
    there = {name: values for name, values in arrays.items() if values is not None}
    return {
        "title": title,
        "points": points_of(data).astype(float).tolist(),
        "radius": _finite(arrays["radius"]),
        "edges": segments_of(data.GetLines(), closed=False).tolist(),
        "triangles": surface_of_data(data)[1].tolist(),
        "smooth": bool(data.GetPointData().HasArray("Normals")),
        "colours": {name: _finite(values) for name, values in there.items()},
        "ranges": {name: colour_range(COLOURS[name], values) for name, values in there.items()},
        "thin": THIN,
        "cloud": _cloud(points_of(source).astype(float)),
    }


def _finite(values: np.ndarray | None) -> list | None:
    return None if values is None else [value if np.isfinite(value) else None for value in values.tolist()]


def _cloud(points: np.ndarray) -> dict:
    """Evenly chosen points in whole steps from the corner of their box."""
    total = len(points)
    if total > CLOUD_POINTS:
        points = points[np.linspace(0, total - 1, CLOUD_POINTS).astype(int)]
    origin = points.min(axis=0) if total else np.zeros(3)
    step = (float(np.ptp(points, axis=0).max()) if total else 0.0) / STEPS or 1.0
    places = np.rint((points - origin) / step).astype(int)
    return {"origin": origin.tolist(), "step": step, "places": places.ravel().tolist(), "total": total}
