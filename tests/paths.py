"""Where things are in the checkout."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = ROOT / "sample_data"
PLUGIN = ROOT / "plugin" / "tetraskel_plugin.py"
SHIM = ROOT / "filters" / "tetraskel" / "paraview_shim"

# for programs the tests start: the package of this checkout, installed or not
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT / "filters")}
