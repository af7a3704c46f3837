"""Pictures as small as can be judged: software draws them, and that takes more time than all else here."""

from __future__ import annotations

import pytest

from tetraskel.cli import comparison_pictures, picture


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    for module in (picture, comparison_pictures):
        monkeypatch.setattr(module, "SIZE", (400, 300))
