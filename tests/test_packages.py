"""Wheel and source distribution hold what they should, and what they hold can be imported elsewhere."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

from paths import ROOT
from tetraskel.kernels.compilation import SWITCH

MODULES = {path.relative_to(ROOT / "filters").as_posix() for path in (ROOT / "filters" / "tetraskel").rglob("*.py")}


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The two files, made without the network from a copy of what is in the checkout."""
    if not can_build():
        pytest.skip("needs setuptools of 2024 or later, or the package wheel, in this environment")
    folder = tmp_path_factory.mktemp("built")
    copy = folder / "copy"
    for name in ("filters", "plugin"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "numba_*"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    code = (
        "import sys; out = sys.argv[1]; sys.argv[1:] = []; from setuptools import build_meta as b; "
        "b.build_sdist(out); b.build_wheel(out)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(folder)], cwd=copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return next(folder.glob("*.tar.gz")), next(folder.glob("*.whl"))


def can_build():
    """Whether this environment makes wheels without the network."""
    if importlib.util.find_spec("setuptools") is None:
        return False
    release = tuple(map(int, importlib.metadata.version("setuptools").split(".")[:2]))
    return release >= (70, 1) or importlib.util.find_spec("wheel") is not None


def test_the_wheel_holds_every_module(built):
    names = set(zipfile.ZipFile(built[1]).namelist())
    assert names >= MODULES
    assert {"tetraskel/py.typed", "tetraskel/paraview_plugin/tetraskel_plugin.py"} <= names
    assert not [name for name in names if name.startswith(("tests", "benchmarks", "docs"))]


def test_the_source_distribution_holds_every_module(built):
    with tarfile.open(built[0]) as whole:
        names = {name.partition("/")[2] for name in whole.getnames()}
    assert names >= {f"filters/{name}" for name in MODULES}
    assert "pyproject.toml" in names


CHAIN = [["--version"], ["plugin-path"], ["skeleton", "ring.csv", "ring.vtp"], ["bezier", "ring.vtp", "smooth.vtp"]]


@pytest.mark.parametrize("kind", ["source distribution", "wheel"])
def test_installed_where_nothing_else_of_the_checkout_is_it_works(built, kind, tmp_path):
    """In an environment of its own, which finds the dependencies and the build tools in this one."""
    home = tmp_path / "home"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", home], check=True)
    folder = "Scripts" if os.name == "nt" else "bin"
    site = next(home.rglob("site-packages"))
    (site / "dependencies.pth").write_text("\n".join(path for path in sys.path if path.endswith("-packages")))
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment[SWITCH] = "0"  # what numba compiles is kept by the place of the package: a minute for each

    def run(*command):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    file = built[["source distribution", "wheel"].index(kind)]
    options = ["--no-index", "--no-deps", "--no-build-isolation", "--ignore-installed"]
    run(home / folder / "python", "-m", "pip", "install", *options, file)
    angle = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.savetxt(tmp_path / "ring.csv", np.concatenate([ring, 0.6 * ring]), "%.9f", ",", header="x,y", comments="")
    said = [run(home / folder / "tetraskel", *arguments) for arguments in CHAIN]
    assert str(site / "tetraskel") in run(home / folder / "python", "-c", "import tetraskel; print(tetraskel.__file__)")
    assert re.search(r"\d+\.\d+", said[0])
    assert Path(said[1]).is_relative_to(site)
    assert Path(said[1]).is_file()
    assert "1 pieces, 1 loops" in said[2]
    assert (tmp_path / "smooth.vtp").stat().st_size > 0


def test_licences_of_dependencies_are_listed():
    listed = (ROOT / "SECURITY.md").read_text(encoding="utf-8").lower()
    needed = re.findall(
        r"^(?:dependencies|fast|raster|dev|docs|test) = \[(.*)\]$", (ROOT / "pyproject.toml").read_text(), re.M
    )
    names = {name for line in needed for name in re.findall(r'"([A-Za-z-]+)', line)}
    assert len(names) >= 8
    assert [name for name in sorted(names) if name.lower() not in listed] == []
