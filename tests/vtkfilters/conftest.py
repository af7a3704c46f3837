"""What all tests of the filters share."""

from __future__ import annotations

import pytest
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow


@pytest.fixture(autouse=True)
def messages():
    """What VTK would have printed."""
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    yield window
    vtkOutputWindow.SetInstance(None)
