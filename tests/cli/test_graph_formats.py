"""Skeletons in the formats of other programs, read back by hand."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import numpy as np
import pytest
import pyvista

from paths import SAMPLES
from tetraskel import curve_model, curve_skeleton, medial_mesh, triangulate
from tetraskel.cli import main
from tetraskel.vtkfilters.progress import ProgressLine

GRAPHML = "{http://graphml.graphdrawing.org/xmlns}"


@pytest.fixture(scope="module")
def skeletons():
    """The curve skeletons of a tube that branches and of one that closes."""
    clouds = {name: np.asarray(pyvista.read(SAMPLES / f"{name}.vtp").points) for name in ("y_tube", "torus")}
    return {name: curve_skeleton(points) for name, points in clouds.items()}


def written(name, path, *options):
    assert main(["skeleton", str(SAMPLES / f"{name}.vtp"), str(path), *map(str, options)]) == 0
    return path


def edge_set(edges):
    return {frozenset(edge) for edge in np.asarray(edges).tolist()}


@pytest.mark.parametrize("name", ["y_tube", "torus"])
def test_swc(tmp_path, skeletons, name):
    skeleton = skeletons[name]
    lines = written(name, tmp_path / "s.swc").read_text().splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = np.array([line.split() for line in lines if not line.startswith("#")], float)
    ids, parents = rows[:, 0].astype(int), rows[:, 6].astype(int)
    assert ids.tolist() == list(range(1, len(skeleton) + 1))
    assert ((parents < ids) & ((parents > 0) | (parents == -1))).all()
    assert (parents == -1).sum() == skeleton.components
    cut = [tuple(map(int, line.split("edge ")[1].split(",")[0].split())) for line in comments[1:]]
    assert len(cut) == skeleton.loops
    assert len(cut) + (parents > 0).sum() == len(skeleton.edges)
    assert np.sort(rows[:, 5]) == pytest.approx(np.sort(skeleton.radius))


def test_graphml(tmp_path, skeletons):
    root = ElementTree.parse(written("torus", tmp_path / "s.graphml")).getroot()
    keys = {key.get("attr.name"): key.get("id") for key in root.iter(f"{GRAPHML}key")}
    nodes = list(root.iter(f"{GRAPHML}node"))
    edges = [(int(e.get("source")[1:]), int(e.get("target")[1:])) for e in root.iter(f"{GRAPHML}edge")]
    x = [float(data.text) for node in nodes for data in node if data.get("key") == keys["x"]]
    assert x == skeletons["torus"].points[:, 0].tolist()
    assert edge_set(edges) == edge_set(skeletons["torus"].edges)


def test_ply(tmp_path, skeletons):
    header, body = written("y_tube", tmp_path / "s.ply").read_text().split("end_header\n")
    skeleton, rows = skeletons["y_tube"], body.splitlines()
    assert f"element vertex {len(skeleton)}" in header
    vertices = np.array([row.split() for row in rows[: len(skeleton)]], float)
    assert np.array_equal(vertices, np.column_stack([skeleton.points, skeleton.radius]))
    assert edge_set([list(map(int, row.split())) for row in rows[len(skeleton) :]]) == edge_set(skeleton.edges)


def test_tables_and_points(tmp_path, skeletons):
    extra = {"--edges": "e.csv", "--table": "t.csv", "--points": "p.vtp"}
    options = [part for flag, file in extra.items() for part in (flag, tmp_path / file)]
    nodes = np.genfromtxt(written("y_tube", tmp_path / "n.csv", *options), delimiter=",", names=True)
    skeleton = skeletons["y_tube"]
    assert nodes["x"].tolist() == skeleton.points[:, 0].tolist()
    assert nodes["ParentId"].tolist() == skeleton.parent.tolist()
    edges = np.loadtxt(tmp_path / "e.csv", delimiter=",", skiprows=1, dtype=int)
    assert edge_set(edges) == edge_set(skeleton.edges)
    table = (tmp_path / "t.csv").read_text().splitlines()
    assert table[0].startswith("CellId,Radius,Length,Curvature,Torsion,Tortuosity,StartPointPosition")
    assert len(table) == skeleton.n_branches + 1
    cloud = pyvista.read(tmp_path / "p.vtp")
    assert np.array_equal(cloud["SkeletonNodeId"], skeleton.point_nodes)


def slab_file(folder):
    """Random points of the larger sides and of the rim of a box 2 x 2 x 0.6, in a file."""
    rng = np.random.default_rng(0)
    points, axis = rng.random((2500, 3)) * [2, 2, 0.6], rng.choice(3, 2500, p=[0.15, 0.15, 0.7])
    points[np.arange(2500), axis] = rng.integers(0, 2, 2500) * np.array([2, 2, 0.6])[axis]
    np.save(folder / "slab.npy", points + rng.normal(0, 1e-4, (2500, 3)))
    return folder / "slab.npy"


@pytest.mark.parametrize(("suffix", "options"), [(".vtp", []), (".vtk", ["--sheet-angle", "60"])])
def test_sheets_are_written_beside_the_skeleton(tmp_path, suffix, options):
    file, sheets = slab_file(tmp_path), tmp_path / f"sheets{suffix}"
    assert main(["skeleton", str(file), str(tmp_path / "s.vtp"), "--sheets", str(sheets), *options]) == 0
    expected = medial_mesh(curve_model(triangulate(np.load(file))), **({"sheet_angle": 60} if options else {}))
    written = pyvista.read(sheets)
    digits = 0 if suffix == ".vtp" else 1e-5  # the older format is text with few digits
    assert np.allclose(written.points, expected.points, rtol=digits, atol=digits)
    assert np.array_equal(written.faces.reshape(-1, 4)[:, 1:], expected.triangles)
    assert np.allclose(written["MaximumInscribedSphereRadius"], expected.radius, rtol=digits, atol=0)
    assert np.allclose(written["ObjectAngle"], expected.angle, rtol=digits, atol=0)


@pytest.mark.parametrize("flag", ["--points", "--sheets"])
def test_no_output_is_written_over_an_input_or_another_output(tmp_path, capsys, monkeypatch, flag):
    monkeypatch.chdir(tmp_path)
    pyvista.PolyData(np.eye(3)).save("in.vtp")
    pyvista.PolyData(np.eye(3)).save("walls.vtp")
    before = (tmp_path / "in.vtp").read_bytes()
    surface = ["--inside", "surface", "--boundary", "walls.vtp"]
    for arguments, message in (
        (["o.vtp", flag, "in.vtp"], "expected an output beside the input, got 'in.vtp' for both"),
        (["o.vtp", flag, str(tmp_path / "walls.vtp"), *surface], "expected an output beside the input"),
        (["o.vtp", flag, "o.vtp"], "expected a file for each output, got 'o.vtp' for two"),
        (["o.vtp", "--points", "p.vtp", "--sheets", "p.vtp"], "expected a file for each output, got 'p.vtp' for two"),
    ):
        assert main(["skeleton", "in.vtp", *arguments]) == 2
        assert message in capsys.readouterr().err
    assert (tmp_path / "in.vtp").read_bytes() == before
    assert not (tmp_path / "o.vtp").exists()


def test_the_paper_s_skeleton_is_a_method(tmp_path):
    tree = pyvista.read(written("y_tube", tmp_path / "t.vtp", "--method", "tree"))
    assert "SubtreeSize" in tree.point_data
    assert main(["skeleton", str(SAMPLES / "y_tube.vtp"), str(tmp_path / "t.swc"), "--method", "tree"]) == 0


def test_measure_prints_a_table_and_json(tmp_path, capsys, monkeypatch):
    torus = pyvista.ParametricTorus(ringradius=1, crosssectionradius=0.35, u_res=40, v_res=30).triangulate()
    torus.save(tmp_path / "torus.ply")
    skeleton = written("torus", tmp_path / "s.vtp")
    capsys.readouterr()
    shown = []
    monkeypatch.setattr(ProgressLine, "show", lambda _, stage, share: shown.append((stage, share)))
    assert main(["measure", str(skeleton), str(tmp_path / "torus.ply"), "--json"]) == 0
    out = capsys.readouterr().out
    numbers = json.loads(out)
    assert out.count("\n") == 1
    assert shown == [("Measuring", share) for share in sorted(share for _, share in shown)]
    assert len(shown) > 3
    assert shown[-1] == ("Measuring", 1.0)
    assert numbers["loops"] == 1
    assert numbers["inside"] == 1
    assert numbers["centredness"] > 0.9
    assert main(["measure", str(skeleton), str(tmp_path / "torus.ply")]) == 0
    assert "centredness" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["skeleton", "in.csv", "o.vtp", "--method", "tree", "--points", "p.vtp"],
            "expected --points with",
        ),
        (["skeleton", "in.csv", "o.vtp", "--method", "tree", "--sheets", "s.vtp"], "expected --sheets with"),
        (["skeleton", "in.csv", "o.vtp", "--sheets", "s.ply"], "expected an output file ending in .vtp .vtk"),
        (["skeleton", "in.csv", "o.vtp", "--sheets", "nowhere/s.vtp"], "expected a folder to write into"),
        (["skeleton", "in.csv", "o.vtp", "--sheet-angle", "200"], "sheet_angle must lie between 0 and 180; got 200"),
        (["skeleton", "in.csv", "o.vtp", "--edges", "e.txt"], "expected an output file ending in .csv"),
        (["skeleton", "in.csv", "o.vtp", "--detail", "2"], "detail must lie between 0 and 1; got 2"),
        (
            ["measure", "line.vtp", "in.csv"],
            "expected the closed surface of the object in 'in.csv', got 50 points and no faces; give a mesh",
        ),
        (["measure", "in.csv", "in.csv"], "expected lines with the point array MaximumInscribedSphereRadius"),
        (["skeleton", "in.csv", "o.vtp"], "expected an object with an inside, got none in 50 points"),
        (["skeleton", "three.csv", "o.vtp"], "expected an object with an inside, got none in 3 points"),
        (["skeleton", "four.csv", "o.vtp"], "expected an object with an inside, got none in 4 points"),
        (["skeleton", "flat.csv", "o.vtp"], "expected an object with an inside, got none in 50 points"),
    ],
)
def test_bad_use_is_one_line(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    cloud = np.random.default_rng(0).random((50, 3))
    flat = cloud * [1, 1, 0]
    for name, points in {"in": cloud, "flat": flat, "three": np.eye(3), "four": np.eye(4)[:, :3]}.items():
        np.savetxt(f"{name}.csv", points, delimiter=",")
    line = pyvista.Line()
    line["MaximumInscribedSphereRadius"] = np.ones(line.n_points)
    line.save("line.vtp")
    assert main(arguments) == 2
    told = capsys.readouterr().err.splitlines()
    assert message in told[-1]
    assert not (tmp_path / "o.vtp").exists()
