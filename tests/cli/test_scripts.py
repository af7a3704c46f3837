"""The commands in scripts: JSON, standard input, several inputs."""

from __future__ import annotations

import io
import json
import types

import numpy as np
import pytest
import pyvista

from commands import run
from paths import SAMPLES
from tetraskel import build_tree, triangulate

CLOUD = SAMPLES / "cloud20.csv"
POLYGON = SAMPLES / "polygon.csv"


def mesh_of(sample):
    return triangulate(np.loadtxt(sample, delimiter=",", skiprows=1))


def tree_of(sample):
    return build_tree(mesh_of(sample))


def test_json_says_what_was_done(tmp_path, capsys):
    out = tmp_path / "tree.vtp"
    status, told, _ = run(capsys, "tree", CLOUD, out, "--json")
    assert status == 0
    assert told.count("\n") == 1
    n, engine = len(tree_of(CLOUD)), mesh_of(CLOUD).engine
    counts = {"input": str(CLOUD), "output": str(out), "input_points": 20, "points": n, "lines": n - 1, "faces": 0}
    facts = {"Engine": engine, "InputPoints": 20, "DuplicatesMerged": 0, "Noise": 0.0, "Traversal": "breadth"}
    facts |= {"Trees": 1, "Leaves": int((tree_of(CLOUD).son_count == 0).sum())}
    assert json.loads(told) == {**counts, "facts": facts}


def test_json_of_what_follows_a_skeleton(tmp_path, capsys):
    files = [tmp_path / name for name in ("s.vtp", "smooth.vtp", "surface.vtp")]
    told = [
        run(capsys, "skeleton", SAMPLES / "bent_tube.vtp", files[0], "--json")[1],
        run(capsys, "bezier", files[0], files[1], "--json")[1],
        run(capsys, "surface", files[1], files[2], "--json")[1],
    ]
    skeleton, smooth, surface = map(json.loads, told)
    assert (skeleton["facts"]["Components"], skeleton["facts"]["Loops"]) == (1, 0)
    assert smooth["facts"]["Pieces"] > 0
    assert surface["faces"] == pyvista.read(files[2]).n_cells > 0


@pytest.fixture
def typed(monkeypatch):
    """Give a command bytes on its standard input."""

    def give(content):
        monkeypatch.setattr("sys.stdin", types.SimpleNamespace(buffer=io.BytesIO(content)))

    return give


def test_a_table_comes_from_standard_input(tmp_path, capsys, typed):
    typed(CLOUD.read_bytes())
    status, out, _ = run(capsys, "tree", "-", tmp_path / "tree.vtp")
    assert status == 0
    assert out.startswith("-: 20 points -> ")
    assert pyvista.read(tmp_path / "tree.vtp").n_points == len(tree_of(CLOUD))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"1 2 3\n4 5\n", "expected 3 cells in each line of 'standard input', got 2 in line 2"),
        (b"\xff\xfe1", "expected a text file in UTF-8, got 'standard input'"),
    ],
)
def test_bad_standard_input_is_one_line(tmp_path, capsys, typed, content, message):
    typed(content)
    status, _, err = run(capsys, "tree", "-", tmp_path / "tree.vtp")
    assert status == 2
    assert message in err
    assert err.count("\n") == 1


def test_several_inputs_give_a_result_each(tmp_path, capsys):
    status, out, _ = run(capsys, "tree", CLOUD, POLYGON, tmp_path, "--json")
    assert status == 0
    told = [json.loads(line) for line in out.splitlines()]
    assert [line["output"] for line in told] == [str(tmp_path / "cloud20.vtp"), str(tmp_path / "polygon.vtp")]
    for sample in (CLOUD, POLYGON):
        assert pyvista.read(tmp_path / f"{sample.stem}.vtp").n_points == len(tree_of(sample))


def test_one_bad_input_does_not_stop_the_others(tmp_path, capsys):
    status, _, err = run(capsys, "skeleton", tmp_path / "none.csv", CLOUD, tmp_path, "--method", "tree")
    assert status == 2
    assert "does not exist" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloud20.vtp"]


@pytest.mark.parametrize(
    ("inputs", "out", "more", "message"),
    [
        ([CLOUD, POLYGON], "out.vtp", [], "expected a folder for the results of 2 inputs, got"),
        ([CLOUD, "-"], "", [], "expected files only where there are several inputs"),
        ([CLOUD, POLYGON], "", ["--png", "p.png"], "expected one input with --png, got 2"),
        ([CLOUD, CLOUD], "", [], "got two that would both give 'cloud20.vtp'"),
    ],
)
def test_what_several_inputs_cannot_have(tmp_path, capsys, inputs, out, more, message):
    status, _, err = run(capsys, "tree", *inputs, tmp_path / out, *more)
    assert status == 2
    assert err.startswith("tetraskel tree: ")
    assert message in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
