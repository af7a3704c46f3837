"""Judge the surface rebuilt from curve skeletons, on the meshes of a folder: python benchmarks/surface_table.py FOLDER.

Prints one Markdown row per mesh (OBJ) and detail, from the vertices of the mesh: distances between the mesh and the
surface rebuilt from the skeleton's lines, and from the smooth curves fitted to them, in percent of the diagonal.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from curve_table import read_obj

from tetraskel import bezier_skeleton, skeleton_surface, surface_error
from tetraskel.kernels.curve import curve_model, draw_curve
from tetraskel.kernels.triangulate import triangulate

DETAILS = (0.5, 0.75, 1.0)


def main(folder: str) -> None:
    print("| shape | detail | from | points / pieces | Euler characteristic | mesh to surface, mean / largest, % | "
          "surface to mesh, % | s |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|")
    for path in sorted(Path(folder).glob("*.obj")):
        mesh = read_obj(path)
        model = curve_model(triangulate(mesh[0]))
        for detail in DETAILS:
            skeleton = draw_curve(model, detail=detail)
            curves = bezier_skeleton(skeleton)
            for kind, source, size in (("lines", skeleton, len(skeleton)), ("curves", curves.skeleton, len(curves))):
                print(row(f"{path.stem} | {detail:g} | {kind} | {size}", source, mesh), flush=True)


def row(name, skeleton, mesh):
    start = time.perf_counter()
    surface = skeleton_surface(skeleton)
    seconds = time.perf_counter() - start
    error = surface_error(surface, *mesh)
    euler = len(surface) - len(surface.simplices) // 2  # three edges for two triangles
    return (
        f"| {name} | {euler} | {error['ErrorMean']:.2f} / {error['ErrorMax']:.1f} | "
        f"{error['BackErrorMean']:.2f} / {error['BackErrorMax']:.1f} | {seconds:.2f} |"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
