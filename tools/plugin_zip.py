"""Pack the ParaView plugin with all it needs: `python tools/plugin_zip.py FILE.zip`.

Unpacked anywhere, the plugin finds its package beside it, as in a checkout. Nothing but the standard library is needed
to pack it. Files have one date, so that the same sources give the same bytes.
"""

from __future__ import annotations

import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE, PLUGIN = ROOT / "filters" / "tetraskel", ROOT / "plugin"
DATE = (2020, 1, 1, 0, 0, 0)
SAMPLE = "sample_data/y_tube.vtp"
READ_ME = """tetraskel {version} for ParaView: skeletons of points and meshes

1. Unpack this folder where it can stay.
2. ParaView: Tools > Manage Plugins > Load New..., choose plugin/tetraskel_plugin.py in this folder, tick Auto Load.
   Nothing has to be installed.
3. Open points ({sample} in this folder), Filters > Skeleton Tree > Curve Skeleton, Apply.

Debian 12 and Ubuntu 24.04: their ParaView 5.11 cannot load any Python plugin. It says "invalid ELF header" or "cannot
import name 'getargspec' from 'inspect'". Start it in this folder with

    PYTHONPATH="$PWD/filters/tetraskel/paraview_shim" paraview

Python scripts: LoadPlugin("FOLDER/plugin/tetraskel_plugin.py", remote=False, ns=globals()) in pvpython or pvbatch.
Servers: load the plugin on the server and on the client, from the same version of this folder.
Macros that draw something in one go are in plugin/macros: Macros > Import new macro.
"""


def version() -> str:
    """The version, without importing the package."""
    return re.search(r'__version__ = "(.+)"', (PACKAGE / "__init__.py").read_text())[1]


def members() -> Iterator[tuple[str, bytes]]:
    """Names and contents of the files."""
    yield "README.txt", READ_ME.format(version=version(), sample=SAMPLE).encode()
    files = [ROOT / "LICENSE", ROOT / SAMPLE, PLUGIN / "tetraskel_plugin.py"]
    files += [*(PLUGIN / "macros").glob("*.py"), *PACKAGE.rglob("*.py"), PACKAGE / "py.typed"]
    for file in sorted(set(files)):
        yield file.relative_to(ROOT).as_posix(), file.read_bytes()


def pack(target: Path) -> None:
    """Write the zip."""
    folder = f"tetraskel-{version()}"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in members():
            entry = zipfile.ZipInfo(f"{folder}/{name}", DATE)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            packed.writestr(entry, content)


if __name__ == "__main__":
    if len(sys.argv) != 2 or not sys.argv[1].endswith(".zip"):
        sys.exit("plugin_zip.py: expected one name that ends in .zip to write to.")
    out = Path(sys.argv[1])
    out.parent.mkdir(parents=True, exist_ok=True)
    pack(out)
    print(out)
