"""`tetraskel skeleton --blocks`: the file that the command writes without it, and one line for what cannot be."""

from __future__ import annotations

import io
import json
import sys

import numpy as np
import pytest
import pyvista

from commands import run
from dealt import torus
from tetraskel.kernels.compilation import numba_is_used

needs_numba = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")
POINTS = np.random.default_rng(0).random((250, 3))


def written(folder, suffix, points=POINTS):
    """A file of the points."""
    file = folder / f"cloud{suffix}"
    if suffix == ".npy":
        np.save(file, points)
    elif suffix == ".vtp":
        pyvista.PolyData(points).save(file)
    else:
        rows = "\n".join(",".join(repr(float(x)) for x in row) + ",7" for row in points)
        file.write_text("\ufeff# made up\nx,y,z,mass\n" + rows + "\n")
    return file


def assert_same(one, other):
    """Two files of polygonal data hold the same, types and order included."""
    a, b = pyvista.read(one), pyvista.read(other)
    assert np.array_equal(a.points, b.points)
    assert np.array_equal(a.lines, b.lines)
    assert np.array_equal(a.verts, b.verts)
    assert a.active_scalars_name == b.active_scalars_name
    for where in ("point_data", "cell_data", "field_data"):
        found, expected = getattr(b, where), getattr(a, where)
        assert list(found) == list(expected)
        for name in expected:
            assert np.array_equal(found[name], expected[name]), name
            assert np.asarray(found[name]).dtype == np.asarray(expected[name]).dtype, name


@needs_numba
@pytest.mark.parametrize("suffix", [".npy", ".csv", ".vtp"])
def test_blocks_write_what_the_serial_command_writes(tmp_path, capsys, suffix):
    source = written(tmp_path, suffix)
    options = ("--method", "tree", "--threshold", "0.1")
    assert run(capsys, "skeleton", source, tmp_path / "whole.vtp", *options)[0] == 0
    status, out, err = run(capsys, "skeleton", source, tmp_path / "blocks.vtp", *options, "--blocks", "3")
    assert (status, err) == (0, "")
    assert out.startswith(f"{source}: 250 points -> {tmp_path / 'blocks.vtp'}: ")
    assert_same(tmp_path / "whole.vtp", tmp_path / "blocks.vtp")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([source.name, "whole.vtp", "blocks.vtp"])


TORUS = torus(np.random.default_rng(0), 700)
INSIDE = {
    "few points": (TORUS, (), "taken for inside is what is 1.5 times larger"),
    "noise": (TORUS + np.random.default_rng(1).normal(0, 0.02, TORUS.shape), ("--noise", "1", "--ratio", "1.4"), ""),
    "nothing": (POINTS, ("--keep-leaves",), "nothing lies inside: no room is 2 times larger"),
}


@needs_numba
@pytest.mark.parametrize("case", INSIDE)
def test_blocks_write_the_tree_of_the_inside(tmp_path, capsys, case):
    points, more, message = INSIDE[case]
    source = written(tmp_path, ".npy", points)
    call = ("--method", "tree", "--inside", "gates", "--threshold", "0.1", "--json", *more)
    said = {}
    for name, blocks in (("whole", ()), ("blocks", ("--blocks", "3"))):
        status, out, err = run(capsys, "skeleton", source, tmp_path / f"{name}.vtp", *call, *blocks)
        assert status == 0
        said[name] = {**json.loads(out), "output": ""}, err
    assert said["blocks"] == said["whole"]
    assert err.count("warning: InteriorCells: ") == err.count("\n") == (message != "")
    assert message in err
    assert (said["whole"][0]["points"] > 100) == (case != "nothing")
    assert_same(tmp_path / "whole.vtp", tmp_path / "blocks.vtp")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([source.name, "whole.vtp", "blocks.vtp"])


@needs_numba
def test_tables_come_in_pieces_and_from_a_pipe(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("tetraskel.cli.pieces.PIECE", 60)
    source = written(tmp_path, ".csv")
    run(capsys, "skeleton", source, tmp_path / "file.vtp", "--method", "tree", "--blocks", "2")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(source.read_bytes())))
    run(capsys, "skeleton", "-", tmp_path / "pipe.vtp", "--method", "tree", "--blocks")
    run(capsys, "skeleton", source, tmp_path / "whole.vtp", "--method", "tree")
    assert_same(tmp_path / "whole.vtp", tmp_path / "file.vtp")
    assert_same(tmp_path / "whole.vtp", tmp_path / "pipe.vtp")


@needs_numba
def test_tables_of_branches_and_json_are_the_serial_ones(tmp_path, capsys):
    source = written(tmp_path, ".npy")
    said = {}
    for name, more in (("whole", ()), ("blocks", ("--blocks", "2"))):
        files = ("--table", tmp_path / f"{name}.csv", "--edges", tmp_path / f"{name}_edges.csv")
        call = ("skeleton", source, tmp_path / f"{name}.vtp", "--method", "tree", "--json", *files, *more)
        status, out, err = run(capsys, *call)
        assert (status, err) == (0, "")
        said[name] = {**json.loads(out), "output": ""}
    assert said["whole"] == said["blocks"]
    for kind in (".csv", "_edges.csv"):
        assert (tmp_path / f"whole{kind}").read_text() == (tmp_path / f"blocks{kind}").read_text()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--blocks",), "expected --method tree with --blocks, got the curve skeleton"),
        (("--blocks", "-1"), "expected --blocks with the number of blocks, got -1"),
        (("--blocks", "--inside", "array"), "expected --inside all or gates with --blocks, got array"),
        (("--blocks", "--inside", "gates", "--ratio", "0.5"), "ratio must lie between"),
        (("--blocks", "--noise", "2"), "expected --noise with --inside gates only"),
        (("--blocks", "--traversal", "depth"), "expected --traversal breadth with --blocks"),
        (("--blocks", "--joggle", "1e-6"), "expected --joggle 0.0 with --blocks"),
        (("--blocks", "--denoise"), "expected --denoise False with --blocks"),
        (("--blocks", "--engine", "qhull"), "expected --engine exact with --blocks, got qhull"),
        (("--blocks", "--threshold", "7"), "threshold must lie between"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_what_blocks_cannot_do_is_said(tmp_path, capsys, options, message):
    method = () if options == ("--blocks",) else ("--method", "tree")
    status, out, err = run(capsys, "skeleton", written(tmp_path, ".npy"), tmp_path / "o.vtp", *method, *options)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err
    assert not (tmp_path / "o.vtp").exists()


def bad_files():
    nan = POINTS.copy()
    nan[[7, 200]] = np.nan
    tetrahedra = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: np.arange(4)[None]}, POINTS[:4])
    return {
        "nan.npy": (lambda file: np.save(file, nan), "got 2 of 250 points with NaN"),
        "nan.csv": (lambda file: np.savetxt(file, nan, delimiter=","), "got 2 of 250 points with NaN"),
        "flat.npy": (lambda file: np.save(file, POINTS[:, :2]), "expected points in space with --blocks"),
        "plane.npy": (lambda file: np.save(file, POINTS * [1, 0, 1]), "got points of one plane"),
        "few.npy": (lambda file: np.save(file, POINTS[:2]), "expected at least 3 distinct points"),
        "none.csv": (lambda file: file.write_text(""), "none.csv', got none."),
        "words.csv": (lambda file: file.write_text("x,y,z\n1,2,3\n1,two,3\n"), "expected numbers in line 3"),
        "ragged.csv": (lambda file: file.write_text("1,2,3\n1,2\n"), "expected 3 cells in each line"),
        "latin.csv": (lambda file: file.write_bytes(b"x,y,z\n1,2,\xe9\n"), "expected a text file in UTF-8"),
        "short.npy": (lambda file: file.write_bytes(b"\x93NUMPY"), "is not a plain array file"),
        "mesh.vtu": (lambda file: tetrahedra.save(file), "add --points-only"),
        "missing.npy": (lambda file: None, "which does not exist"),
        "cloud.abc": (lambda file: file.write_text("1"), "expected a file ending in"),
    }


@needs_numba
@pytest.mark.parametrize("name", bad_files())
def test_bad_files_are_named_and_nothing_stays(tmp_path, capsys, name):
    write, message = bad_files()[name]
    write(tmp_path / name)
    before = sorted(tmp_path.iterdir())
    call = ("skeleton", tmp_path / name, tmp_path / "o.vtp", "--method", "tree", "--blocks", "2")
    status, out, err = run(capsys, *call)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err
    assert sorted(tmp_path.iterdir()) == before


def test_other_outputs_and_places_are_refused_before_any_work(tmp_path, capsys):
    source = written(tmp_path, ".npy")
    status, _, err = run(capsys, "skeleton", source, tmp_path / "o.csv", "--method", "tree", "--blocks")
    assert (status, "expected an output file ending in .vtp with --blocks" in err) == (2, True)
    status, _, err = run(capsys, "skeleton", source, tmp_path / "no" / "o.vtp", "--method", "tree", "--blocks")
    assert (status, "expected a folder to write into" in err) == (2, True)


@needs_numba
@pytest.mark.parametrize("inside", ["all", "gates"])
def test_ctrl_c_leaves_nothing(tmp_path, capsys, monkeypatch, inside):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tetraskel.distributed.in_process._wait_for", _once(interrupted))
    source = written(tmp_path, ".npy")
    call = ("skeleton", source, tmp_path / "o.vtp", "--method", "tree", "--blocks", "2", "--inside", inside)
    status, _, err = run(capsys, *call)
    assert (status, "stopped; nothing was written" in err) == (130, True)
    assert list(tmp_path.iterdir()) == [source]


def _once(fail):
    """The first wait for the threads fails, the others wait."""
    calls = []

    def wait(threads):
        calls.append(1)
        if len(calls) == 1:
            fail()
        for thread in threads:
            thread.join()

    return wait


def test_standard_input_is_not_drawn(tmp_path, capsys):
    call = ("skeleton", "-", tmp_path / "o.vtp", "--method", "tree", "--blocks", "--png", tmp_path / "o.png")
    status, out, err = run(capsys, *call)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert "expected a file of points for --png and --html with --blocks, got standard input" in err
