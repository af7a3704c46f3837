"""Files are untrusted input: nothing in them is run, and no header makes the program allocate, hang or crash."""

from __future__ import annotations

import ast
import os
import pickle
import resource
import signal
import time

import numpy as np
import pytest
import pyvista

from paths import ROOT
from tetraskel import InputError
from tetraskel.cli import main, trial
from tetraskel.cli.files import read
from tetraskel.cli.swc import read_swc

HUGE = {
    "huge.vtk": b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4000000000 double\n0 0 0\n",
    "huge.ply": b"ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n",
    "huge.vti": b'<VTKFile type="ImageData" version="1.0"><ImageData WholeExtent="0 99999 0 99999 0 99999" '
    b'Origin="0 0 0" Spacing="1 1 1"><Piece Extent="0 99999 0 99999 0 99999"><PointData/></Piece></ImageData>'
    b"</VTKFile>",
    "huge.vtp": b'<VTKFile type="PolyData" version="1.0"><PolyData><Piece NumberOfPoints="9999999999999" '
    b'NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0"><Points>'
    b'<DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0</DataArray></Points>'
    b"</Piece></PolyData></VTKFile>",
}  # fmt: skip


@pytest.mark.parametrize("name", HUGE)
def test_headers_that_promise_too_much(name, tmp_path, capfd):
    (tmp_path / name).write_bytes(HUGE[name])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert main(["tree", str(tmp_path / name), str(tmp_path / "out.vtp")]) == 2
    told = capfd.readouterr().err.splitlines()
    assert len(told) == 1
    assert told[0].startswith("tetraskel tree: ")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 500_000  # kB
    assert not (tmp_path / "out.vtp").exists()


def test_a_header_of_npy_that_does_not_end(tmp_path):
    """Found by fuzzing: NumPy reads such a header as Python once more, piece by piece."""
    np.save(tmp_path / "a.npy", np.zeros((30, 3)))
    content = (tmp_path / "a.npy").read_bytes().replace(b"(30, 3), }", b"(30, 3,  \x12")
    (tmp_path / "a.npy").write_bytes(content)
    with pytest.raises(InputError, match="is not a plain array file"):
        read(str(tmp_path / "a.npy"))


def test_a_header_of_npy_that_promises_too_much(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((4, 3)))
    content = (tmp_path / "a.npy").read_bytes().replace(b"(4, 3), }" + 12 * b" ", b"(4000000000000, 3), }")
    (tmp_path / "a.npy").write_bytes(content)
    with pytest.raises(InputError, match="holds less than its header says"):
        read(str(tmp_path / "a.npy"))


def test_nothing_is_unpickled(tmp_path):
    """An array of objects would run what it likes when it is loaded."""
    np.save(tmp_path / "a.npy", np.array([[Bomb(tmp_path / "gone off"), 0]], dtype=object), allow_pickle=True)
    (tmp_path / "b.npy").write_bytes(pickle.dumps(Bomb(tmp_path / "gone off")))
    for name in ("a.npy", "b.npy"):
        with pytest.raises(InputError, match="is not a plain array file"):
            read(str(tmp_path / name))
    assert not (tmp_path / "gone off").exists()


class Bomb:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return open, (str(self.path), "w")


def test_no_code_that_runs_what_it_reads():
    """No eval, exec, pickle or shell in the package; np.load always says that it takes no objects."""
    for file in (ROOT / "filters").rglob("*.py"):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                names = [alias.name for alias in node.names] + [getattr(node, "module", "") or ""]
                assert not {name.split(".")[0] for name in names} & {"pickle", "marshal", "shelve", "subprocess"}, file
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                assert called not in ("eval", "exec", "os.system", "os.popen"), file
                if called == "np.load":
                    assert any(k.arg == "allow_pickle" and k.value.value is False for k in node.keywords), file


def test_cells_that_name_points_that_are_not_there(tmp_path):
    data = pyvista.PolyData(np.random.default_rng(0).random((4, 3)))
    data.lines = [4, 0, 1, 2, 3]
    data.save(tmp_path / "a.vtp", binary=False)
    text = (tmp_path / "a.vtp").read_text()
    start = text.index('Name="connectivity"', text.index("<Lines>"))
    (tmp_path / "a.vtp").write_text(text[:start] + text[start:].replace("0 1 2 3", "0 1 2 7", 1))
    with pytest.raises(InputError, match="got some that name others"):
        read(str(tmp_path / "a.vtp"))


def test_pyvista_does_not_log_what_we_say(tmp_path, capfd):
    (tmp_path / "a.vti").write_bytes(b"no image at all")
    assert main(["raster", str(tmp_path / "a.vti"), str(tmp_path / "out.vtp")]) == 2
    assert len(capfd.readouterr().err.splitlines()) == 1


def test_a_skeleton_that_is_no_polygonal_data(tmp_path, capfd):
    pyvista.PolyData(np.random.default_rng(0).random((9, 3))).delaunay_3d().save(tmp_path / "a.vtu")
    pyvista.Sphere().save(tmp_path / "b.vtp")
    assert main(["measure", str(tmp_path / "a.vtu"), str(tmp_path / "b.vtp")]) == 2
    assert "expected a skeleton as polygonal data" in capfd.readouterr().err


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
class TestTrial:
    def test_of_what_can_be_read(self, tmp_path):
        file = tmp_path / "a.vtk"
        file.write_text("x")
        trial.try_to_read(file, lambda: None)

    def test_of_what_crashes(self, tmp_path):
        file = tmp_path / "a.vtk"
        file.write_text("x")
        with pytest.raises(InputError, match="its header promises more than it holds"):
            trial.try_to_read(file, lambda: os.kill(os.getpid(), signal.SIGSEGV))

    def test_of_what_wants_too_much(self, tmp_path):
        file = tmp_path / "a.vtk"
        file.write_text("x")
        with pytest.raises(InputError, match="its header promises more than it holds"):
            trial.try_to_read(file, lambda: np.ones(1 << 33))

    def test_of_what_takes_too_long(self, tmp_path, monkeypatch):
        file = tmp_path / "a.vtk"
        file.write_text("x")
        monkeypatch.setattr(trial, "LEAST_SECONDS", 0.2)
        with pytest.raises(InputError, match="takes too long"):
            trial.try_to_read(file, lambda: time.sleep(60))

    def test_tells_the_reason(self, tmp_path):
        file = tmp_path / "a.vtk"
        file.write_text("x")

        def refuse():
            raise InputError("expected something else, got this.")

        with pytest.raises(InputError, match=r"^expected something else, got this\.$"):
            trial.try_to_read(file, refuse)


def test_numbers_of_an_swc_that_are_none(tmp_path):
    for row in ("nan 0 0 0 0 1 -1", "1 0 0 0 0 1 nan", "1e400 0 0 0 0 1 -1"):
        (tmp_path / "a.swc").write_text(row)
        with pytest.raises(InputError, match="expected"):
            read_swc(tmp_path / "a.swc", "r")
