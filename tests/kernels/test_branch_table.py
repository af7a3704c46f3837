"""The table of branches, by curves whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel.kernels.branch_table import COLUMNS, branch_table


def row_of(path, radius=None):
    radius = np.ones(len(path)) if radius is None else radius
    rows = branch_table(path, radius, np.array([0, len(path)]), np.arange(len(path)))
    return dict(zip(COLUMNS, rows[0], strict=True))


def test_a_helix_has_its_curvature_and_torsion():
    t = np.linspace(0, 4 * np.pi, 4001)
    row = row_of(np.stack([2 * np.cos(t), 2 * np.sin(t), t], axis=1))
    assert row["Curvature"] == pytest.approx(2 / 5, rel=1e-3)
    assert row["Torsion"] == pytest.approx(1 / 5, rel=1e-3)
    assert row["Length"] == pytest.approx(4 * np.pi * np.sqrt(5), rel=1e-6)
    assert row["Tortuosity"] == pytest.approx(np.sqrt(5) - 1, rel=1e-6)


def test_a_straight_line_has_none():
    row = row_of(np.array([[0, 0, 0], [1, 0, 0], [4, 0, 0]], float), np.array([1.0, 1.0, 3.0]))
    assert (row["Curvature"], row["Torsion"], row["Tortuosity"]) == (0, 0, 0)
    assert row["Radius"] == pytest.approx((1 * 1 + 3 * 2) / 4)
    assert row["EndPointPosition"] == "4 0 0"


def test_a_closed_branch_is_infinitely_tortuous():
    assert row_of(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], float))["Tortuosity"] == np.inf
