"""Colours stand for the same values in pictures, windows, pages and comparisons, under numbers that differ."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
import pyvista

from commands import run
from paths import SAMPLES
from tetraskel.cli import picture
from tetraskel.cli.colours import DEPTH, RADIUS, colour_range, legend


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        (RADIUS, [0.2957, 0.3005], (0, 0.3005)),
        (RADIUS, [np.nan, 2, np.inf], (0, 2)),
        (RADIUS, [0, 0], (0, 1)),
        (RADIUS, [-2, -1], (0, 1)),
        (RADIUS, [], (0, 1)),
        (DEPTH, [3, 9, 4], (3, 9)),
        (DEPTH, [5, 5], (5, 10)),
        (DEPTH, [], (0, 1)),
        (DEPTH, [-4, -4], (-4, 0)),
    ],
)
def test_the_range_of_colours(name, values, expected):
    assert colour_range(name, values) == expected


@pytest.mark.parametrize("name", [RADIUS, DEPTH])
@pytest.mark.parametrize("most", [1, 2, 3, 7, 1001])
def test_the_numbers_of_a_legend_differ(name, most):
    limits = colour_range(name, [0, most] if name == DEPTH else [0.99 * most, most])
    bar = legend(name, limits)
    numbers = [bar["fmt"] % value for value in np.linspace(*limits, bar["n_labels"])]
    assert len(set(numbers)) == bar["n_labels"]


def test_a_picture_and_a_page_of_one_tube_begin_at_zero(tmp_path, capsys, monkeypatch):
    seen = []

    def noted(plotter, *args, **kwargs):
        fill(plotter, *args, **kwargs)
        seen.extend(bar.GetLookupTable().GetRange() for bar in plotter.scalar_bars.values())

    fill = picture.fill
    monkeypatch.setattr(picture, "fill", noted)
    files = [tmp_path / name for name in ("o.vtp", "o.png", "o.html")]
    done = run(capsys, "skeleton", SAMPLES / "y_tube.vtp", files[0], "--png", files[1], "--html", files[2])
    assert done[0] == 0
    most = pyvista.read(files[0])[RADIUS].max()
    (geometry,) = re.findall(r'id="geometry">(.*?)</script>', files[2].read_text(encoding="utf-8"), re.DOTALL)
    assert json.loads(geometry)["ranges"]["radius"] == [0, pytest.approx(most)]
    assert seen == [(0, pytest.approx(most))]
