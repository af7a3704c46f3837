"""How programs of ParaView are found and started, as their users start them."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess

import pytest

from paths import ROOT, SHIM
from tetraskel.kernels.compilation import SWITCH

REQUIRED = os.environ.get("TETRASKEL_REQUIRE_PARAVIEW") == "1"
SECONDS = 300
_screens = itertools.count(os.getpid() * 37, 7)
# what numba compiles for ParaView's own Python
KEPT = os.environ.get("TETRASKEL_RANKS_CACHE", str(ROOT / ".pvpython-packages" / "numba-cache"))


def virtual_screen():
    """Words for xvfb-run, which looks for a free screen from a number on: far from what starts at the same time."""
    return ("-a", "-n", str(100 + next(_screens) % 800))


def program(name):
    """Path of a program; without it the test is skipped, or fails where ParaView is required."""
    found = shutil.which(name)
    if found is None:
        skip_or_fail(f"{name} is not installed (Debian: apt-get install paraview python3-paraview xvfb)")
    return found


def skip_or_fail(reason):
    """Skip what cannot be run here, except where ParaView is required."""
    pytest.fail(reason) if REQUIRED else pytest.skip(reason)


def environment(**more):
    """Without this environment's own packages: ParaView brings its own VTK.

    Without numba, too, where a test does not ask for it: each home would compile everything anew.
    """
    kept = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV", "DISPLAY")}
    return {**kept, "PYTHONPATH": str(SHIM), SWITCH: "0", **more}


def finished(command, folder, more):
    """A program of ParaView, run to its end in a folder."""
    return subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, env=environment(**more), cwd=folder)
