"""Every error of the kernels through every face: kernel, VTK filter, ParaView, PyVista and shell say the same."""

from __future__ import annotations

import ast
import json
import re
from functools import cache
from pathlib import Path

import pytest
import pyvista
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from bad_input import ROWS
from paths import PLUGIN, ROOT
from programs import finished, program
from test_parity import in_panel, method_of
from tetraskel import TetraskelError, cli, vtkfilters
from tetraskel.vtkfilters.base import camel_case

KERNELS = ROOT / "filters" / "tetraskel" / "kernels"
THROUGH_FILTERS = [name for name, row in ROWS.items() if row.data]
ELSEWHERE = {  # they depend on what is installed, or on sizes no quick test has
    "the exact engine could not be compiled": "tests/kernels/test_triangulate.py",
    "engine needs the package": "tests/kernels/test_triangulate.py",
    "expected scikit-image for thinning": "tests/kernels/test_raster.py",
    "the exact engine holds": "tests/kernels/test_exact_engine.py",
    "expected coordinates whose sizes differ": "tests/kernels/test_exact_engine.py",
}


def pattern_of(node):
    """The regular expression of a message in the source."""
    if isinstance(node, ast.Constant):
        return re.escape(str(node.value))
    if isinstance(node, ast.JoinedStr):
        return "".join(map(pattern_of, node.values))
    if isinstance(node, ast.BinOp):
        return pattern_of(node.left) + pattern_of(node.right)
    return "(?s:.*)"


def raised_in(file):
    """The patterns of the errors a kernel raises."""
    raises = [node.exc for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Raise)]
    made = [call for call in raises if isinstance(call, ast.Call) and getattr(call.func, "id", "").endswith("Error")]
    return {pattern_of(call.args[0]) for call in made}


PATTERNS = sorted(set().union(*map(raised_in, KERNELS.rglob("*.py"))))


@cache
def of_kernel(name):
    """What the kernel says."""
    with pytest.raises(TetraskelError) as caught:
        ROWS[name].kernel()
    return str(caught.value)


def sentence(name, face):
    """What a face is to say."""
    own = ROWS[name].own
    return own.get(face) or own.get("filter") or of_kernel(name)


@pytest.mark.parametrize("name", ROWS)
def test_the_kernel_says_what_was_expected_and_what_came(name):
    message = of_kernel(name)
    words = (
        r"expected .*, got |the graph has |drew |Qhull |the \w+ engine found |the engine left |.* needs the package "
    )
    assert re.match(words, message)
    assert message.endswith(".")
    assert "\n" not in message


@pytest.mark.parametrize("pattern", PATTERNS)
def test_every_error_of_the_kernels_has_a_row(pattern):
    told = [name for name in ROWS if re.fullmatch(pattern, of_kernel(name))]
    other = [file for words, file in ELSEWHERE.items() if re.search(re.escape(re.escape(words)), pattern)]
    assert told or other
    assert not told or not other
    assert all((ROOT / file).is_file() for file in other)


@pytest.mark.parametrize("name", ROWS)
def test_who_cannot_be_given_it_says_why(name):
    assert bool(ROWS[name].data) != bool(ROWS[name].why)


@pytest.mark.parametrize("name", THROUGH_FILTERS)
def test_the_filter(name):
    row, window = ROWS[name], vtkStringOutputWindow()
    step = getattr(vtkfilters, row.filter)(**row.options)
    step.SetInputDataObject(0, row.data())
    if row.second:
        step.SetInputDataObject(1, row.second())
    vtkOutputWindow.SetInstance(window)
    try:
        with pytest.raises(TetraskelError, match=f"^{re.escape(sentence(name, 'filter'))}$"):
            step.run()
    finally:
        vtkOutputWindow.SetInstance(None)
    assert window.GetOutput().split("\n") == [f"{row.filter}: {sentence(name, 'filter')}", "", ""]
    assert step.GetOutputDataObject(0).GetNumberOfPoints() == 0


@pytest.mark.parametrize("name", THROUGH_FILTERS)
def test_the_accessor(name):
    row = ROWS[name]
    second = {vtkfilters.__dict__[row.filter].second_input[0].lower(): row.second()} if row.second else {}
    with pytest.raises(TetraskelError, match=f"^{re.escape(sentence(name, 'filter'))}$"):
        getattr(row.data().tetraskel, method_of(row.filter))(**row.options, **second)


SUFFIX = {pyvista.PolyData: ".vtp", pyvista.UnstructuredGrid: ".vtu", pyvista.ImageData: ".vti"}


def saved(data, path):
    """A data set in a file of its kind."""
    file = Path(path).with_suffix(SUFFIX[type(data)])
    data.save(file)
    return str(file)


@pytest.mark.parametrize("name", THROUGH_FILTERS)
def test_the_shell(name, tmp_path, capsys):
    row = ROWS[name]
    command, *options = row.command.split()
    if row.second:
        options.append(saved(row.second(), tmp_path / "second"))
    out = tmp_path / "out.vtp"
    assert cli.main([command, saved(row.data(), tmp_path / "in"), str(out), *options]) == cli.BAD_USAGE
    said = capsys.readouterr()
    assert said.err == f"tetraskel {command}: {sentence(name, 'shell')}\n"
    assert said.out == ""
    assert not out.exists()


SCRIPT = """
import json, sys
from paraview.simple import *
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
LoadPlugin(sys.argv[1], remote=False, ns=globals())
READERS = {"vtp": XMLPolyDataReader, "vtu": XMLUnstructuredGridReader, "vti": XMLImageDataReader}
said = {}
for name, (file, second, port, kind, options) in json.load(open("rows.json")).items():
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    inputs = {"Input": READERS[file[-3:]](FileName=file)}
    if second:
        inputs[port] = READERS[second[-3:]](FileName=second)
    proxy = globals()[kind](**inputs, **options)
    proxy.UpdatePipeline()
    said[name] = [window.GetOutput().strip("\\n"), proxy.GetDataInformation().GetNumberOfPoints()]
json.dump(said, open("said.json", "w"))
"""


@pytest.fixture(scope="module")
def in_paraview(tmp_path_factory):
    """What ParaView says of each row, from one pvpython."""
    executable, folder = program("pvpython"), tmp_path_factory.mktemp("errors")
    told = {}
    for number, name in enumerate(THROUGH_FILTERS):
        row = ROWS[name]
        files = [saved(row.data(), folder / f"in{number}"), row.second and saved(row.second(), folder / f"by{number}")]
        port = getattr(vtkfilters, row.filter).second_input[0] if row.second else None
        told[name] = (*files, port, row.filter, {camel_case(key): in_panel(it) for key, it in row.options.items()})
    (folder / "rows.json").write_text(json.dumps(told))
    (folder / "script.py").write_text(SCRIPT)
    done = finished([executable, "script.py", str(PLUGIN)], folder, {})
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads((folder / "said.json").read_text())


@pytest.mark.parametrize("name", THROUGH_FILTERS)
def test_paraview_has_one_red_line(name, in_paraview):
    assert in_paraview[name] == [f"{ROWS[name].filter}: {sentence(name, 'filter')}", 0]


def test_an_error_without_a_row_is_found(tmp_path):
    file = tmp_path / "kernel.py"
    file.write_text("def fail(n):\n    raise InputError(f'expected luck, got {n}; ' 'try again.')\n")
    (pattern,) = raised_in(file)
    assert re.fullmatch(pattern, "expected luck, got 13; try again.")
    with pytest.raises(AssertionError):
        test_every_error_of_the_kernels_has_a_row(pattern)
