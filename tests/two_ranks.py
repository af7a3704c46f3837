"""A cloud in pieces, and programs of ParaView on two MPI ranks that read it."""

from __future__ import annotations

import os
import subprocess

import numpy as np
import pyvista

from paths import PLUGIN
from programs import KEPT, environment, program
from tetraskel.kernels.compilation import BESIDE, CACHE, FOLDER, SWITCH

NUMBA = os.environ.get(FOLDER, str(PLUGIN.parent / BESIDE))
EXACT = {FOLDER: NUMBA, CACHE: KEPT, SWITCH: "1"}
SECONDS = 240


def write_pieces(folder, points, n_pieces=2):
    """A file of points dealt to pieces at random, some of them to all, with global ids and an array."""
    rng = np.random.default_rng(0)
    owner = rng.integers(0, n_pieces, len(points))
    for rank in range(n_pieces):
        ids = np.flatnonzero((owner == rank) | (np.arange(len(points)) % 50 == 0))
        piece = pyvista.PolyData(points[ids])
        piece["weight"] = ids * 2.0
        piece.point_data.active_scalars_name = None
        piece["ids"] = ids.astype(np.int64)
        piece.GetPointData().SetActiveAttribute("ids", 5)  # global ids
        piece.save(folder / f"piece{rank}.vtp")
    (folder / "cloud.pvtp").write_text(
        '<VTKFile type="PPolyData" version="0.1"><PPolyData GhostLevel="0"><PPointData GlobalIds="ids">'
        '<PDataArray type="Float64" Name="weight"/><PDataArray type="Int64" IdType="1" Name="ids"/></PPointData>'
        '<PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>'
        + "".join(f'<Piece Source="piece{rank}.vtp"/>' for rank in range(n_pieces))
        + "</PPolyData></VTKFile>"
    )


def mpirun(folder, *command, **more):
    """Start a program on two ranks."""
    start = [program("mpirun"), "--allow-run-as-root", "--oversubscribe", "-np", "2", *map(str, command)]
    return subprocess.Popen(
        start, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(**more)
    )


def batch(folder, script, *arguments, sym=True, **more):
    """Run a script in pvbatch on two ranks, to its end."""
    (folder / "script.py").write_text(script)
    flags = ["--sym"] if sym else []
    process = mpirun(folder, program("pvbatch"), *flags, "script.py", *arguments, **more)
    out, err = process.communicate(timeout=SECONDS)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)
