"""Programs of a real ParaView, started as their users start them."""

from __future__ import annotations

import pytest

from paths import PLUGIN, ROOT
from programs import SCREEN, finished, program, skip_or_fail


@pytest.fixture
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
        start = [program("xvfb-run"), *SCREEN] if screen else []
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
        command = [screen, *SCREEN, "-s", "-screen 0 1600x1000x24", executable, "--dr", *extra]
        command += [f"--test-directory={tmp_path}", f"--test-script={xml}", "--exit"]
        return finished(command, tmp_path, more)

    return run
