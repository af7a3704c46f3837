"""Programs of a real ParaView, started as their users start them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import pyvista

from paths import PLUGIN, ROOT
from programs import finished, program, skip_or_fail, virtual_screen
from tubes import TUBES


@pytest.fixture(scope="session")
def small(tmp_path_factory):
    """A file of few points of a torus: ParaView's Python has no compiled loops here."""
    file = tmp_path_factory.mktemp("small") / "torus.vtp"
    pyvista.PolyData(TUBES["torus"]().sample(900)).save(file)
    return file


@pytest.fixture(scope="session")
def missing():
    """What to call when something is not installed."""
    return skip_or_fail


@pytest.fixture
def pvpython(tmp_path):
    """Run a script in pvpython, with a virtual `screen` where it draws; gives its standard output and error."""
    executable = program("pvpython")

    def run(script, *arguments, screen=False, **more):
        file = tmp_path / "script.py"
        file.write_text(f"PLUGIN = {str(PLUGIN)!r}\nROOT = {str(ROOT)!r}\nfrom paraview.simple import *\n{script}")
        start = [program("xvfb-run"), *virtual_screen()] if screen else []
        return finished([*start, executable, str(file), *map(str, arguments)], tmp_path, more)

    return run


class Part(NamedTuple):
    """What one of several scripts left."""

    printed: str
    said: str  # on standard error
    folder: Path
    name: str

    @property
    def arrays(self):
        """What it saved."""
        return np.load(self.folder / f"{self.name}.npz")


PART = re.compile(r"^== (\w+)\n", re.M)
BEGIN = """
import sys
import numpy as np
from vtkmodules.numpy_interface.dataset_adapter import WrapDataObject
def begin(name):
    global save
    for stream in (sys.stdout, sys.stderr):
        print("==", name, file=stream, flush=True)
    save = lambda **arrays: np.savez(name + ".npz", **arrays)
"""


@pytest.fixture(scope="module")
def in_one_pvpython(tmp_path_factory):
    """Run scripts one behind the other in one pvpython, whose start takes most of the time; gives parts by name."""
    executable = program("pvpython")

    def run(scripts, prepare=None, screen=False, **more):
        folder = tmp_path_factory.mktemp("parts")
        if prepare:
            prepare(folder)
        parts = [f"begin({name!r})\n{script}" for name, script in scripts.items()]
        head = f"PLUGIN = {str(PLUGIN)!r}\nROOT = {str(ROOT)!r}\nfrom paraview.simple import *\n{BEGIN}"
        (folder / "script.py").write_text(head + "\n".join(parts))
        start = [program("xvfb-run"), *virtual_screen()] if screen else []
        done = finished([*start, executable, "script.py"], folder, more)
        assert done.returncode == 0, done.stderr
        printed, said = (PART.split(text) for text in (done.stdout, done.stderr))
        assert (printed[0], said[0]) == ("", ""), done.stderr
        assert printed[1::2] == said[1::2] == list(scripts)
        told = zip(scripts, printed[2::2], said[2::2], strict=True)
        return {name: Part(out, err, folder, name) for name, out, err in told}

    return run


@pytest.fixture
def paraview(tmp_path):
    """Play a list of GUI events in a ParaView window on a virtual screen; gives the finished process."""
    executable, screen = program("paraview"), program("xvfb-run")

    def run(events, script=None, **more):
        xml = tmp_path / "events.xml"
        xml.write_text(f'<?xml version="1.0" ?>\n<pqevents>\n{events}\n</pqevents>\n')
        extra = []
        if script:
            (tmp_path / "script.py").write_text(f"from paraview.simple import *\n{script}")
            extra = [f"--script={tmp_path / 'script.py'}"]
        command = [screen, *virtual_screen(), "-s", "-screen 0 1600x1000x24", executable, "--dr", *extra]
        command += [f"--test-directory={tmp_path}", f"--test-script={xml}", "--exit"]
        return finished(command, tmp_path, more)

    return run
