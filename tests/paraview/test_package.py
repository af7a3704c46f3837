"""What a user unpacks, loads and opens: the zip of `make plugin`, the macro, the saved state, the shim's note."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import pytest

from paths import PLUGIN, ROOT, SAMPLES
from programs import finished, program
from tetraskel import __version__, vtkfilters
from tetraskel.cli import main, plugin_path
from tetraskel.vtkfilters.paraview_display import LOOKS, REPRESENTATIONS
from tetraskel.vtkfilters.paraview_xml import page_of, panel_xml

TOOL = ROOT / "tools" / "plugin_zip.py"
USE = """
import sys
from paraview.simple import *
LoadPlugin(sys.argv[1], remote=False, ns=globals())
cloud = XMLPolyDataReader(FileName=sys.argv[2])
tree = TreeBuilder(Input=DelaunayMesh(Input=cloud))
tree.UpdatePipeline()
import tetraskel
print(tree.GetDataInformation().GetNumberOfPoints(), tetraskel.__file__)
"""


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """The zip, made as `make plugin` makes it."""
    file = tmp_path_factory.mktemp("dist") / "plugin.zip"
    subprocess.run([sys.executable, str(TOOL), str(file)], check=True, stdout=subprocess.DEVNULL)
    return file


def test_the_zip_is_used_where_it_is_unpacked(packed, tmp_path):
    executable = program("pvpython")
    home, place = tmp_path / "home", tmp_path / "a folder"
    home.mkdir()
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(place)
    (folder,) = place.iterdir()
    (tmp_path / "use.py").write_text(USE)
    command = [executable, str(tmp_path / "use.py"), str(folder / "plugin" / PLUGIN.name), str(SAMPLES / "box8.vtp")]
    shim = folder / "filters" / "tetraskel" / "paraview_shim"
    done = finished(command, home, {"HOME": str(home), "PYTHONPATH": str(shim)})
    assert (done.returncode, done.stderr) == (0, "")
    n_nodes, package = done.stdout.strip().split(" ", 1)
    assert n_nodes == "6"
    assert package == str(folder / "filters" / "tetraskel" / "__init__.py")
    assert list(home.iterdir()) == [] or [one.name for one in home.iterdir()] == [".config"]


def test_the_zip_says_how_it_is_used(packed):
    with zipfile.ZipFile(packed) as archive:
        folder = f"tetraskel-{__version__}/"
        names = archive.namelist()
        assert all(name.startswith(folder) and "__pycache__" not in name for name in names)
        named = re.findall(r"[\w./]+/[\w.]+\.\w+", archive.read(folder + "README.txt").decode().replace("FOLDER/", ""))
        assert {"plugin/tetraskel_plugin.py", "sample_data/y_tube.vtp"} <= set(named)
        assert all(any(name.endswith(path) for name in names) for path in named)
        in_plugin = [name for name in names if re.fullmatch(r"[^/]+/plugin/[^/]+\.py", name)]
        assert in_plugin == [f"{folder}plugin/tetraskel_plugin.py"]  # ParaView executes all there is


def test_the_same_sources_give_the_same_zip(packed, tmp_path):
    subprocess.run([sys.executable, str(TOOL), str(tmp_path / "again.zip")], check=True, stdout=subprocess.DEVNULL)
    assert (tmp_path / "again.zip").read_bytes() == packed.read_bytes()


def test_another_name_is_refused():
    done = subprocess.run([sys.executable, str(TOOL), "plugin.tar"], capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr == "plugin_zip.py: expected one name that ends in .zip to write to.\n"


@pytest.mark.parametrize(("line", "noted"), [("from inspect import getargspec", True), ("import inspect", False)])
def test_who_needs_the_shim_is_told(line, noted, tmp_path, monkeypatch, capsys):
    detail = tmp_path / "lib" / "python3" / "dist-packages" / "paraview" / "detail"
    detail.mkdir(parents=True)
    (detail / "pythonalgorithm.py").write_text(line + "\n")
    started = tmp_path / "bin" / "paraview"
    started.parent.mkdir()
    started.write_text("")
    started.chmod(0o755)
    monkeypatch.setenv("PATH", str(started.parent))
    assert main(["plugin-path"]) == 0
    said = capsys.readouterr()
    assert said.out == f"{PLUGIN}\n"
    assert ("start it as: PYTHONPATH=" in said.err) == noted
    assert ("invalid ELF header" in said.err) == noted
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not plugin_path.needs_shim()


REOPEN = """
import json
LoadPlugin(PLUGIN, remote=False, ns=globals())
LoadState(ROOT + "/sample_data/skeleton_in_object.pvsm", data_directory=ROOT + "/sample_data")
inside, skeleton = FindSource("inside"), FindSource("skeleton")
for proxy in (inside, skeleton):
    proxy.UpdatePipeline()
counts = [proxy.GetDataInformation().GetNumberOfPoints() for proxy in (inside, skeleton)]
found = {"counts": counts, "detail": skeleton.Detail, "method": str(inside.Method).strip("'")}
lines = GetDisplayProperties(skeleton, GetActiveView())
found["lines"] = [lines.LineWidth, lines.RenderLinesAsTubes, lines.ColorArrayName[1]]
Delete(skeleton)
skeleton = CurveSkeleton(registrationName="once more", Input=inside, Detail=0.25, Root="Widest")
SaveState("once_more.pvsm")
ResetSession()
LoadState("once_more.pvsm")
again = FindSource("once more")
found["again"] = [again.Detail, str(again.Root).strip("'")]
json.dump(found, open("found.json", "w"))
"""


def test_the_saved_state_reopens(pvpython, tmp_path):
    done = pvpython(REOPEN, screen=True)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["counts"] == [6000, 72]
    assert (found["detail"], found["method"]) == (0.5, "Gates")
    assert found["lines"] == [6.0, 1, "MaximumInscribedSphereRadius"]
    assert found["again"] == [0.25, "Widest"]


def test_a_paraview_that_is_too_old_is_told(monkeypatch):
    monkeypatch.setattr(sys, "version_info", (3, 9, 13))
    with pytest.raises(ImportError, match=r"needs a ParaView with Python 3\.10 or later, .*; this one has Python 3\.9"):
        exec(compile(PLUGIN.read_text(), str(PLUGIN), "exec"), {"__file__": str(PLUGIN)})


@pytest.mark.parametrize("name", [name for name in vtkfilters.__all__ if name != "SkeletonFilter"])
def test_what_is_told_can_be_told_from_what_is_asked(name):
    """Names of a proxy's properties in scripts are their labels; each is one property."""
    panel = ElementTree.fromstring(f"<Proxy>{panel_xml(getattr(vtkfilters, name))}</Proxy>")
    own = [one for one in panel if one.tag.endswith("Property")]
    labels = [one.get("label", one.get("name")).replace(" ", "") for one in own]
    assert len(set(labels)) == len(labels)
    grouped = [one.get("name") for one in panel.iter("Property")]
    assert set(grouped) <= {one.get("name") for one in own}
    told = [one for one in own if one.get("information_only")]
    assert len(told) == len(getattr(vtkfilters, name).tells) > 0
    assert all(one.find("Documentation").text for one in own)
    page = page_of(getattr(vtkfilters, name))
    assert panel.find("Documentation").text.endswith(f" {page}.")
    assert "](../pictures/" in (ROOT / page).read_text(encoding="utf-8")


def test_every_output_has_a_look():
    for name in vtkfilters.__all__:
        if name != "SkeletonFilter":
            cls = getattr(vtkfilters, name)
            assert len(cls.drawn_as) == cls.n_outputs
            assert set(cls.drawn_as) <= set(LOOKS)
    declared = re.findall(r"representation\(\"(\w+)\"\)", PLUGIN.read_text())
    assert tuple(declared) == REPRESENTATIONS
