"""Files of every format, spoilt: cut off, with bytes exchanged, with numbers in their headers that promise too much."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyvista

Rng = np.random.Generator


def whole_files(folder: Path) -> list[Path]:
    """A small good file of every format, ASCII and binary."""
    points = np.random.default_rng(0).random((30, 3))
    cloud = pyvista.PolyData(points)
    cloud["Heat"] = points[:, 0]
    lines = pyvista.PolyData(points[:4])
    lines.lines = [4, 0, 1, 2, 3]
    lines["MaximumInscribedSphereRadius"] = np.full(4, 0.1)
    grid = cloud.delaunay_3d()
    image = pyvista.ImageData(dimensions=(4, 4, 3))
    image["mask"] = np.arange(48) % 3 * 1.0
    made = {
        "a.vtp": cloud, "lines.vtp": lines, "a.vtu": grid, "a.vti": image,
        "a.vtk": cloud, "lines.vtk": lines, "grid.vtk": grid,
        "a.ply": pyvista.Sphere(theta_resolution=5, phi_resolution=5),
        "a.stl": pyvista.Sphere(theta_resolution=5, phi_resolution=5),
    }  # fmt: skip
    for name, data in made.items():
        for binary in (True, False):
            data.save(folder / f"{'b' if binary else 't'}{name}", binary=binary)
    pyvista.Sphere(theta_resolution=5, phi_resolution=5).save(folder / "a.obj")
    np.save(folder / "a.npy", points)
    np.savetxt(folder / "a.csv", points, delimiter=",", header="x,y,z", comments="")
    np.savetxt(folder / "a.xyz", points)
    rows = [f"{k + 1} 0 {x} {y} {z} 0.1 {k or -1}" for k, (x, y, z) in enumerate(points[:6])]
    (folder / "a.swc").write_text("\n".join(rows))
    return sorted(folder.iterdir())


def cut(content: bytes, rng: Rng) -> bytes:
    return content[: int(rng.integers(0, len(content) + 1))]


def bytes_exchanged(content: bytes, rng: Rng) -> bytes:
    spoilt = bytearray(content)
    for place in rng.integers(0, max(len(content), 1), int(rng.integers(1, 8))):
        spoilt[place] = int(rng.integers(256))
    return bytes(spoilt)


def head_exchanged(content: bytes, rng: Rng) -> bytes:
    spoilt = bytearray(content)
    for place in rng.integers(0, max(min(len(content), 300), 1), int(rng.integers(1, 5))):
        spoilt[place] = int(rng.integers(32, 127))
    return bytes(spoilt)


def numbers_grown(content: bytes, rng: Rng) -> bytes:
    """One whole number, mostly of the header, becomes large, negative, or no number."""
    found = list(re.finditer(rb"(?<![\w.])\d+(?![\w.])", content[:4000]))
    if not found:
        return content
    one = found[rng.integers(len(found))]
    other = [b"-1", b"0", b"99999999", b"4000000000", b"9999999999999", b"1e9", b"nan", b""][rng.integers(8)]
    return content[: one.start()] + other + content[one.end() :]


def pieces_moved(content: bytes, rng: Rng) -> bytes:
    lines = content.split(b"\n")
    a, b = rng.integers(0, len(lines), 2)
    lines[a], lines[b] = lines[b], lines[a]
    if rng.random() < 0.5:
        del lines[rng.integers(len(lines))]
    return b"\n".join(lines)


def garbage(content: bytes, rng: Rng) -> bytes:
    return rng.integers(0, 256, int(rng.integers(0, 400)), dtype=np.uint8).tobytes()


SPOILERS: dict[str, Callable[[bytes, Rng], bytes]] = {
    made.__name__: made
    for made in (cut, bytes_exchanged, head_exchanged, numbers_grown, numbers_grown, pieces_moved, garbage)
}


def spoilt(file: Path, to: Path, rng: Rng) -> str:
    """Write a spoilt copy; the name of what was done."""
    name = str(
        rng.choice(
            ["cut", "bytes_exchanged", "head_exchanged", "numbers_grown", "numbers_grown", "pieces_moved", "garbage"]
        )
    )
    to.write_bytes(SPOILERS[name](file.read_bytes(), rng))
    return name
