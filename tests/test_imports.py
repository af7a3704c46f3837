"""Imports run one way, and the kernels load without VTK."""

from __future__ import annotations

import ast
import subprocess
import sys

import pytest

from paths import ENVIRONMENT, ROOT

PACKAGE = ROOT / "filters" / "tetraskel"
LAYERS = [
    "errors",
    "options",
    "kernels",
    "pipeline",
    "comparison",
    "distributed",
    "vtkfilters",
    "pyvista_accessor",
    "cli",
]


def layer_of(module):
    parts = module.split(".")
    return LAYERS.index(parts[1]) if len(parts) > 1 and parts[1] in LAYERS else None


def imported_modules(tree):
    """Names of the modules a file imports where it is loaded, not inside functions."""
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_import_points_to_a_later_layer(path):
    own = layer_of("tetraskel." + path.relative_to(PACKAGE).with_suffix("").as_posix().replace("/", "."))
    for module in imported_modules(ast.parse(path.read_text())):
        other = layer_of(module) if module.startswith("tetraskel.") else None
        assert own is None or other is None or other <= own, f"{path.name} imports {module}"


def test_kernels_load_neither_vtk_nor_pyvista_nor_scipy():
    code = "import sys, tetraskel, tetraskel.pipeline; print(*sorted(sys.modules))"
    command = [sys.executable, "-c", code]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True, env=ENVIRONMENT).stdout.split()
    assert "tetraskel.kernels.tree" in loaded
    assert not {name.split(".")[0] for name in loaded} & {"vtkmodules", "vtk", "pyvista", "scipy"}
