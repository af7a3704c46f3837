"""Judge the curve skeleton against the true axes of tubes: python benchmarks/axes_table.py

Prints the table of docs/gallery.md for the clouds of its pictures: distances from the axis, errors of the radius away
from junctions, and from each end to the nearest end of an axis, all in percent of the local radius.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from tetraskel import curve_skeleton
from tetraskel.kernels.curve_skeleton import END, JUNCTION, Skeleton
from tetraskel.kernels.measures import samples_along

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "docs")]
from make_pictures import GALLERY_POINTS

from tubes import TUBES, Tube, radius_error

N_POINTS, SEED = 8000, 2


def main() -> None:
    print(
        "| shape | pieces / loops / ends / junctions | axis, mean / largest | radius, mean | ends |\n"
        + "|---" * 5
        + "|"
    )
    for name, make in TUBES.items():
        tube = make()
        print(row(name, tube, curve_skeleton(tube.sample(GALLERY_POINTS.get(name, N_POINTS), seed=SEED))), flush=True)


def row(name: str, tube: Tube, skeleton: Skeleton) -> str:
    places, weights = samples_along(skeleton, 400)
    off = 100 * tube.axis_distance(places)
    counts = skeleton.components, skeleton.loops, *((skeleton.node_type == kind).sum() for kind in (END, JUNCTION))
    ends = 100 * ends_off(skeleton, tube)
    cells = [
        name,
        " / ".join(map(str, counts)),
        f"{(weights * off).sum() / weights.sum():.1f} / {off.max():.2g}",
        f"{100 * radius_error(skeleton, tube):.1f}",
        f"{ends.min():.0f} to {ends.max():.0f}" if len(ends) else "",
    ]
    return f"| {' | '.join(cells)} |"


def ends_off(skeleton: Skeleton, tube: Tube) -> np.ndarray:
    """Distance of each end from the nearest end of an axis, in its radius."""
    tips = np.array([axis[k] for axis in tube.axes for k in (0, -1)])
    ends = skeleton.points[skeleton.node_type == END]
    away = np.linalg.norm(ends[:, None] - tips, axis=2).min(axis=1)
    return np.asarray(away / tube.local_radius(ends))


if __name__ == "__main__":
    main()
