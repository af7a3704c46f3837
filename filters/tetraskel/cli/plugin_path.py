"""Print where the ParaView plugin file is, to load it with Tools > Manage Plugins.

With --shim, print the folder to put on PYTHONPATH for the ParaView 5.11 of Debian and Ubuntu instead, which cannot load
any Python plugin without it.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from tetraskel.errors import InputError

PACKAGE = Path(__file__).resolve().parents[1]
PLACES = (PACKAGE.parents[1] / "plugin", PACKAGE / "paraview_plugin")  # a checkout, an installation
EXAMPLES = (
    ("The file to load in ParaView:", "plugin-path"),
    ("What the ParaView 5.11 of Debian and Ubuntu needs on its PYTHONPATH:", "plugin-path --shim"),
)

NOTE = (
    'note: the ParaView on this machine loads Python plugins only with a shim (else it says "invalid ELF header"); '
    "start it as: PYTHONPATH={shim} paraview"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel plugin-path` takes."""
    parser.add_argument(
        "--shim", action="store_true", help="print the folder that lets ParaView 5.11 of Debian load it"
    )


def run(chosen: argparse.Namespace) -> None:
    """Print the path."""
    print(PACKAGE / "paraview_shim" if chosen.shim else plugin_file())
    if not chosen.shim and needs_shim():
        print(NOTE.format(shim=PACKAGE / "paraview_shim"), file=sys.stderr)


def needs_shim() -> bool:
    """Whether the ParaView on the path is one that cannot load a Python plugin, as those of Debian 12."""
    program = shutil.which("paraview") or shutil.which("pvpython")
    if program is None:
        return False
    prefix = Path(program).resolve().parents[1]
    modules = prefix.glob("lib/python3*/*-packages/paraview/detail/pythonalgorithm.py")
    return any("import getargspec" in file.read_text(errors="replace") for file in modules)


def plugin_file() -> Path:
    """The plugin file of this installation."""
    for place in PLACES:
        if (place / "tetraskel_plugin.py").is_file():
            return place / "tetraskel_plugin.py"
    raise InputError("the plugin file tetraskel_plugin.py is missing from this installation; install tetraskel again.")
