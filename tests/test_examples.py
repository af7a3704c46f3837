"""The examples run as they stand, each with a number it asserts, and draw something."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import pyvista

from paths import ENVIRONMENT, ROOT

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def test_there_are_examples():
    assert len(EXAMPLES) >= 3


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_it_runs_and_draws(example, tmp_path):
    assert "\nassert " in example.read_text()
    picture = tmp_path / "picture.png"
    command = [sys.executable, "-W", "error", str(example), str(picture)]
    environment = {**ENVIRONMENT, "PYVISTA_OFF_SCREEN": "true"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert len(np.unique(pyvista.read(picture).active_scalars, axis=0)) > 50  # colours, not a blank window
