"""The sample files are what their script makes, and give the answers that are known."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import numpy as np
import pytest
import pyvista

from paths import ROOT, SAMPLES
from tetraskel import bezier_skeleton, build_tree, curve_skeleton, remove_flat, triangulate
from tetraskel.kernels.quality import qualities, volumes
from tetraskel.pipeline import tree_skeleton

ANSWERS = json.loads((SAMPLES / "answers.json").read_text())


def cloud(name):
    file = SAMPLES / ANSWERS[name]["file"]
    if file.suffix == ".csv":
        return np.loadtxt(file, delimiter=",", skiprows=1)
    return np.asarray(pyvista.read(file).points)


def test_script_makes_the_files_again(tmp_path):
    subprocess.run([sys.executable, SAMPLES / "make_samples.py", tmp_path], check=True, capture_output=True)
    made = sorted(path.name for path in tmp_path.iterdir())
    assert len(made) >= 9
    for name in made:
        if name.endswith((".csv", ".json")):
            assert (tmp_path / name).read_bytes() == (SAMPLES / name).read_bytes(), name
        else:  # another zlib may pack the same points otherwise
            assert np.array_equal(pyvista.read(tmp_path / name).points, pyvista.read(SAMPLES / name).points), name


@pytest.mark.parametrize("name", ANSWERS)
def test_points_are_counted(name):
    points = cloud(name)
    assert len(points) == ANSWERS[name]["n_points"]
    assert triangulate(points).dim == ANSWERS[name]["dimension"]


@pytest.mark.parametrize("name", ["rectangle8", "polygon", "cloud20"])
def test_triangulation_is_the_one_found_by_trying_all(name):
    mesh, known = triangulate(cloud(name)), ANSWERS[name]
    assert sorted(map(sorted, mesh.simplices.tolist())) == known["simplices"]
    assert len(build_tree(mesh)) == known["n_simplices"]
    assert volumes(mesh).sum() == pytest.approx(known.get("area", known.get("volume")))


def test_tree_of_the_rectangle_is_a_path():
    tree, known = build_tree(triangulate(cloud("rectangle8"))), ANSWERS["rectangle8"]
    assert tree.is_leaf.sum() == known["tree_leaves"]
    assert tree.depth.max() == known["tree_max_depth"]


def test_box_without_flat_tetrahedra_is_the_box():
    mesh, known = triangulate(cloud("box8"), joggle=1e-6), ANSWERS["box8"]
    assert (qualities(mesh) < 0.01).any()
    kept = remove_flat(build_tree(mesh))
    assert len(kept) in known["n_simplices_without_flat"]
    assert {round(v) for v in volumes(mesh)[kept.cell]} <= set(known["tetrahedron_volumes"]) - {0}
    assert volumes(mesh)[kept.cell].sum() == pytest.approx(known["volume"])


@pytest.mark.parametrize("name", ANSWERS)
def test_the_chain_runs_on_every_sample(name):
    skeleton = tree_skeleton(cloud(name))
    assert len(skeleton.points)
    assert np.isfinite(skeleton.points).all()


def test_detail_shows_more_of_the_limbs_as_first_steps_says():
    drawn = [curve_skeleton(cloud("limbs"), detail=detail) for detail in (0, 0.5, 1)]
    lines = [len(skeleton.branch_length) for skeleton in drawn]
    text = " ".join((ROOT / "docs" / "first_steps.md").read_text(encoding="utf-8").split())
    (told,) = re.findall(r"the commands print (\d+) lines, (\d+) lines and (\d+) lines", text)
    assert lines == list(map(int, told))
    assert len(set(lines)) == len(lines)
    assert lines[0] < ANSWERS["limbs"]["n_ends"]
    assert (drawn[-1].node_degree == 1).sum() == ANSWERS["limbs"]["n_ends"]


@pytest.mark.parametrize("name", [name for name, known in ANSWERS.items() if "axis" in known])
def test_curves_through_tubes_are_at_most_a_third_of_their_vertices(name):
    before = curve_skeleton(cloud(name))
    curves = bezier_skeleton(before)
    assert curves.skeleton.n_branches == before.n_branches
    assert 0 < 3 * len(curves) <= len(before)
