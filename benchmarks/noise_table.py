"""What noise does to the curve skeleton, with and without denoising: python benchmarks/noise_table.py FOLDER

Prints the table of docs/curve.md: independent random points of each mesh (OBJ) in the folder, each moved by a normal
error, for several seeds; ends of each seed, and means of the measures.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from curve_table import independent_samples, read_obj

from tetraskel.kernels.curve import curve_skeleton
from tetraskel.kernels.measures import measure

N_POINTS, SEEDS = 20_000, (0, 1, 2)
NOISES = (0.005, 0.01)  # of the diagonal
MEASURES = ("inside", "centredness", "reconstruction_mean")


def main(folder: str) -> None:
    print("| shape | noise, % | with: ends, inside, centredness, reconstruction % | without |\n" + "|---" * 4 + "|")
    for path in sorted(Path(folder).glob("*.obj")):
        surface = read_obj(path)
        diagonal = np.linalg.norm(np.ptp(surface[0], axis=0))
        for noise in NOISES:
            cells = []
            for denoise in (True, False):
                found = []
                for seed in SEEDS:
                    points = independent_samples(*surface, N_POINTS, seed)
                    points += np.random.default_rng(seed).normal(0, noise * diagonal, points.shape)
                    found.append(measure(curve_skeleton(points, denoise=denoise), surface))
                ends = " ".join(f"{one['ends']:.0f}" for one in found)
                inside, centredness, off = (np.mean([one[name] for one in found]) for name in MEASURES)
                cells.append(f"{ends}, {100 * inside:.3g} %, {centredness:.2f}, {off:.2f}")
            print(f"| {path.stem} | {100 * noise:g} | {cells[0]} | {cells[1]} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
