"""Draw what ParaView shows after the first Apply of each filter: `python docs/paraview_pictures.py [FILTER ...]`.

Needs ParaView and Xvfb. The window is driven by its own widgets, with nothing set after Apply; the picture is read from
the virtual screen. Look at every picture before it is kept.
"""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from gui import APPLY, choose_filter, playlist  # noqa: E402
from programs import environment, program  # noqa: E402

WIDTH, HEIGHT = 1280, 980
WINDOW = f"""[General]
GeneralSettings.ShowWelcomeDialog=false
[MainWindow]
Size=@Size({WIDTH} {HEIGHT})
Position=@Point(0 0)
"""
DRAWING, LONGEST = 2.0, 200.0  # seconds
SAMPLES = ROOT / "sample_data"
LOAD = """
from paraview.simple import *
cloud = {source}
shown = Show(cloud)
SetActiveSource(cloud)
view = GetActiveView()
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [1, -2, 0.8], [0, 0, 0], [0, 0, 1]
ResetCamera()
"""
TREE = ("DelaunayMesh", "TreeBuilder")
FEW = "PointSource(registrationName='points', NumberOfPoints=60, Radius=1.0)"
STEPS = {  # the sample, and the filters that are applied before the one shown
    "CurveSkeleton": ("tree_of_tubes", ()),
    "DelaunayMesh": ("torus", ()),
    "InteriorCells": ("torus", ("DelaunayMesh",)),
    "TreeBuilder": (FEW, ("DelaunayMesh",)),
    "FlatTetraRemoval": (FEW, TREE),
    "SkeletonOutput": (FEW, (*TREE, "FlatTetraRemoval")),
    "SkeletonSurface": ("tree_of_tubes", ("CurveSkeleton",)),
    "BezierSkeleton": ("tree_of_tubes", ("CurveSkeleton",)),
    "VoronoiSkeleton": ("torus", ()),
    "RasterSkeleton": ("y_tube", ()),
}


def picture_of(name: str, file: Path) -> None:
    """Apply the filters of a step in a ParaView of its own, and keep its window."""
    sample, before = STEPS[name]
    file_of_sample = str(SAMPLES / f"{sample}.vtp")
    source = f"XMLPolyDataReader(registrationName={sample!r}, FileName={file_of_sample!r})"
    source = sample if "(" in sample else source
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        (here / "script.py").write_text(LOAD.format(source=source))
        (here / "events.xml").write_text(
            playlist([event for one in (*before, name) for event in (choose_filter(one), APPLY)])
        )
        (here / ".config" / "ParaView").mkdir(parents=True)
        for version in ("5.11.0", "5.11.0-dirty"):
            (here / ".config" / "ParaView" / f"ParaView{version}.ini").write_text(WINDOW)
        screen = subprocess.Popen(
            [program("Xvfb"), ":97", "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder],
            stderr=subprocess.DEVNULL,
        )
        time.sleep(1)
        command = [program("paraview"), f"--script={here / 'script.py'}", f"--test-directory={here}"]
        log = here / "log"
        with log.open("wb") as said:
            window = subprocess.Popen(
                [*command, f"--test-script={here / 'events.xml'}"],
                env=environment(DISPLAY=":97", PV_PLUGIN_PATH=str(ROOT / "plugin"), HOME=folder, QT_FONT_DPI="72"),
                cwd=here,
                stdout=said,
                stderr=said,
            )
        try:
            wait(log)
            image = screen_of(here / "Xvfb_screen0")
        finally:
            for process in (window, screen):
                process.terminate()
                process.wait()
    save(image, file)


def wait(log: Path) -> None:
    """Until ParaView says that it has played the events, and has drawn."""
    begun = time.monotonic()
    while b"is finished" not in log.read_bytes():
        if time.monotonic() - begun > LONGEST:
            raise TimeoutError(f"ParaView has not played the events in {LONGEST:g} seconds.")
        time.sleep(0.2)
    time.sleep(DRAWING)
    if b"Success =  true" not in log.read_bytes() or b"Error" in log.read_bytes():
        raise RuntimeError(f"ParaView says: {log.read_text()}")


def screen_of(dump: Path) -> np.ndarray:
    """(height, width, 3) colours from the file of an X virtual framebuffer (the format XWD, version 7)."""
    data = dump.read_bytes()
    header = np.frombuffer(data, ">u4", 25)
    start, width, height, row, n_colors = (int(header[k]) for k in (0, 4, 5, 12, 19))
    pixels = np.frombuffer(data, np.uint8, height * row, start + 12 * n_colors).reshape(height, row)
    return pixels[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]


def save(image: np.ndarray, file: Path) -> None:
    """A small PNG (1.2, colour type 3): the commonest colours are its palette, others become the nearest of these."""
    colors, which, times = np.unique(image.reshape(-1, 3) & 0xF8, axis=0, return_inverse=True, return_counts=True)
    palette = colors[np.argsort(-times, kind="stable")[:256]]
    apart = ((colors[:, None].astype(int) - palette[None].astype(int)) ** 2).sum(axis=2)
    rows = apart.argmin(axis=1)[which.reshape(-1)].reshape(image.shape[:2]).astype(np.uint8)
    unfiltered = np.insert(rows, 0, 0, axis=1).tobytes()
    head = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 3, 0, 0, 0)
    parts = [(b"IHDR", head), (b"PLTE", palette.astype(np.uint8).tobytes())]
    parts += [(b"IDAT", zlib.compress(unfiltered, 9)), (b"IEND", b"")]
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts))


def chunk(kind: bytes, data: bytes) -> bytes:
    """A chunk of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


if __name__ == "__main__":
    os.chdir(ROOT)
    out = Path(os.environ.get("PICTURES", ROOT / "docs" / "pictures"))
    for chosen in sys.argv[1:] or STEPS:
        picture_of(chosen, out / f"paraview_{chosen}.png")
        print(out / f"paraview_{chosen}.png", flush=True)
