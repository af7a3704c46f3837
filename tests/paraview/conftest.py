"""Programs of a real ParaView, started as their users start them."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

from paths import PLUGIN, ROOT, SHIM

REQUIRED = os.environ.get("TETRASKEL_REQUIRE_PARAVIEW") == "1"
SECONDS = 300


def program(name):
    """Path of a program; without it the test is skipped, or fails where ParaView is required."""
    found = shutil.which(name)
    if found is None:
        skip_or_fail(f"{name} is not installed (Debian: apt-get install paraview python3-paraview xvfb)")
    return found


def skip_or_fail(reason):
    """Skip what cannot be run here, except where ParaView is required."""
    pytest.fail(reason) if REQUIRED else pytest.skip(reason)


@pytest.fixture
def missing():
    """What to call when something is not installed."""
    return skip_or_fail


def environment(**more):
    """Without this environment's own packages: ParaView brings its own VTK."""
    kept = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV", "DISPLAY")}
    return {**kept, "PYTHONPATH": str(SHIM), **more}


def finished(command, folder, more):
    """A program of ParaView, run to its end in a folder."""
    return subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, env=environment(**more), cwd=folder)


@pytest.fixture
def pvpython(tmp_path):
    """Run a script in pvpython, with a virtual `screen` where it draws; gives its standard output and error."""
    executable = program("pvpython")

    def run(script, *arguments, screen=False, **more):
        file = tmp_path / "script.py"
        file.write_text(f"PLUGIN = {str(PLUGIN)!r}\nROOT = {str(ROOT)!r}\nfrom paraview.simple import *\n{script}")
        start = [program("xvfb-run"), "-a"] if screen else []
        return finished([*start, executable, str(file), *map(str, arguments)], tmp_path, more)

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
        command = [screen, "-a", "-s", "-screen 0 1600x1000x24", executable, "--dr", *extra]
        command += [f"--test-directory={tmp_path}", f"--test-script={xml}", "--exit"]
        return finished(command, tmp_path, more)

    return run
