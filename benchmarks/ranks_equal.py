"""Whether tree and inside on all ranks are the serial ones, array for array, on clouds of every kind: a row for each.

    mpirun -np 4 pvbatch --sym benchmarks/ranks_equal.py [POINTS [MESH.obj ...]]

with `PYTHONPATH` naming `filters` and `TETRASKEL_NUMBA_PATH` a folder with numba. Of a mesh the vertices are taken.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests"), str(Path(__file__).resolve().parent)]
from curve_table import read_obj

from dealt import CLOUDS, dealt
from shapes import SOLIDS
from tetraskel.distributed.communicator import together
from tetraskel.distributed.flat import contract_part
from tetraskel.distributed.interior import interior_of_part
from tetraskel.distributed.mpi import MpiCommunicator
from tetraskel.distributed.skeleton import skeleton_part
from tetraskel.distributed.tree import build_tree_part
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.kernels.flat import remove_flat
from tetraskel.kernels.gates import gate_arrays, gate_tree
from tetraskel.kernels.interior import interior
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.skeleton import assemble_skeleton
from tetraskel.kernels.tree import build_tree
from tetraskel.kernels.triangulate import ready_engine, triangulate
from tetraskel.options import InteriorOptions

FOREST = ("parent", "depth", "son_rank", "son_count", "subtree_size", "tree_id")
SKELETON = ("parent", "degree", "node_type", "branch_id")
GATES = ("width", "room_radius", "parent")
THRESHOLD = 0.3


def serial(points):
    """Every array of the chain, in the serial order."""
    mesh = triangulate(points, engine="exact")
    tree = build_tree(mesh)
    kept = remove_flat(tree, threshold=THRESHOLD)
    skeleton = assemble_skeleton(kept)
    found = {"simplices": mesh.simplices, "cell": tree.cell, "kept cell": kept.cell}
    gates = gate_arrays(gate_tree(mesh), mesh.neighbors)
    found |= {"inside": interior(mesh), "inside noisy": interior(mesh, noise=2.0)}
    found |= {f"gate {name}": getattr(gates, name) for name in GATES}
    found |= {f"tree {name}": getattr(tree.forest, name) for name in FOREST}
    found |= {f"kept {name}": getattr(kept.forest, name) for name in FOREST}
    return found | {f"skeleton {name}": getattr(skeleton, name) for name in SKELETON}


def on_ranks(comm, points, owner):
    """The same of all ranks, on the first of them."""
    mine = np.flatnonzero(owner == comm.rank)
    part = triangulate_part(comm, points[mine], mine).part
    walked = build_tree_part(comm, part)
    flat = (qualities(part.mesh) < THRESHOLD)[walked.cell]
    kept, rows = contract_part(comm, walked.forest, flat)
    drawn = skeleton_part(comm, kept)
    told = interior_of_part(comm, part, InteriorOptions(), with_arrays=True)
    noisy = interior_of_part(comm, part, InteriorOptions(noise=2.0))
    arrays = {"simplices": (part.cell_ids, part.point_ids[part.mesh.simplices])}
    arrays |= {"inside": (part.cell_ids, told.inside), "inside noisy": (part.cell_ids, noisy.inside)}
    arrays |= {f"gate {name}": (part.cell_ids, getattr(told.gates, name)) for name in GATES}
    for stage, forest, cells in (("tree", walked.forest, walked.cell), ("kept", kept, walked.cell[rows])):
        arrays["cell" if stage == "tree" else "kept cell"] = (forest.number, part.cell_ids[cells])
        arrays |= {f"{stage} {name}": (forest.number, getattr(forest, name)) for name in FOREST}
    arrays |= {f"skeleton {name}": (drawn.index, getattr(drawn, name)) for name in SKELETON}
    return {name: in_order(comm, *pair) for name, pair in arrays.items()}


def in_order(comm, ids, values):
    ids, values = (comm.gather(np.ascontiguousarray(array)) for array in (ids, values))
    return values[np.argsort(ids)]


def main(n="2000", *meshes):
    from mpi4py import MPI

    comm = MpiCommunicator(MPI.COMM_WORLD)
    warnings.simplefilter("ignore")  # where nothing lies inside
    ready_engine("exact", 3)
    clouds = {cloud.__name__: cloud(np.random.default_rng(0), int(n)) for cloud in CLOUDS}
    clouds |= {name: SOLIDS[name]().sample(int(n), np.random.default_rng(0)) for name in ("two_balls", "bottle")}
    clouds |= {Path(mesh).stem: read_obj(Path(mesh))[0] for mesh in meshes}
    for name, points in clouds.items():
        expected = serial(points) if comm.rank == 0 else {}
        for by in ("random", "space"):
            owner = dealt(points, comm.size, by, np.random.default_rng(1))
            found = together(comm, lambda points=points, owner=owner: on_ranks(comm, points, owner))
            unlike = [key for key, values in expected.items() if not np.array_equal(values, found[key])]
            if comm.rank == 0:
                share = f"{expected['inside'].mean():.0%} inside"
                told = ", ".join(unlike) or "equal"
                print(f"| {name} | {len(points)} | {comm.size} | {by} | {share} | {told} |", flush=True)


main(*sys.argv[1:])
