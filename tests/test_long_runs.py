"""Many runs in one process, and runs that are stopped: memory does not grow, nothing is left behind."""

from __future__ import annotations

import gc
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
import pyvista

import tetraskel
from checks import hull_facets
from tetraskel import Aborted, InsideWarning
from tetraskel.vtkfilters import CurveSkeleton, DelaunayMesh, SkeletonOutput, TreeBuilder
from tubes import TUBES

STATUS = Path("/proc/self/statm")
pytestmark = pytest.mark.filterwarnings("ignore::tetraskel.InsideWarning")  # few points for the thickness of the torus
CLOUDS = 1000
GROWTH = 4 << 20  # bytes that the allocator may keep; a leak of one small array per cloud is more


def resident():
    gc.collect()
    return int(STATUS.read_text().split()[1]) * 4096


@pytest.mark.skipif(not STATUS.exists(), reason="memory is read from /proc")
def test_a_thousand_clouds_take_no_more_memory_than_some():
    rng = np.random.default_rng(0)

    def one(number):
        points = rng.random((12, 3))
        if number % 10 == 0:
            whole = tetraskel.triangulate(points)
            tetraskel.curve_skeleton(whole, inside=np.ones(len(whole)))
        source = pyvista.PolyData(points)
        mesh, tree, drawn = DelaunayMesh(), TreeBuilder(), SkeletonOutput()
        mesh.SetInputDataObject(0, source)
        tree.SetInputConnection(0, mesh.GetOutputPort())
        drawn.SetInputConnection(0, tree.GetOutputPort())
        drawn.run()

    for number in range(CLOUDS // 2):
        one(number)
    before = resident()
    for number in range(CLOUDS // 2):
        one(number)
    assert resident() - before < GROWTH


def stages(points):
    """Every stage that tells how far it is, each as a function of its tick."""
    mesh = tetraskel.triangulate(points)
    tree = tetraskel.build_tree(mesh)
    inside = tetraskel.interior(mesh)
    model = tetraskel.curve_model(mesh)
    skeleton = tetraskel.draw_curve(model)
    mask = tetraskel.rasterise(mesh, inside=inside, resolution=24)
    core = tetraskel.raster_skeleton(mask.values)
    surface = tetraskel.skeleton_surface(skeleton, max_cells=3000)
    hull = hull_facets(mesh)
    flat = tetraskel.triangulate(points[:200, :2])
    noisy, ring = points + 0.02 * np.random.default_rng(0).normal(size=points.shape), hull_facets(flat)
    return {
        "triangulate": lambda tick: tetraskel.triangulate(points, tick=tick),
        "denoised": lambda tick: tetraskel.denoised(noisy, tick),
        "thinned": lambda tick: tetraskel.thinned(points, most_points=len(points) // 3, tick=tick),
        "build_tree": lambda tick: tetraskel.build_tree(mesh, tick=tick),
        "remove_flat": lambda tick: tetraskel.remove_flat(tree, tick=tick),
        "gate_tree": lambda tick: tetraskel.gate_tree(mesh, tick=tick),
        "interior": lambda tick: tetraskel.interior(mesh, tick=tick),
        "interior by surface": lambda tick: tetraskel.interior(
            mesh, method="surface", surface=(mesh.points, hull), tick=tick
        ),
        "inside_by_outline": lambda tick: tetraskel.inside_by_outline(flat, flat.points * 0.7, ring, tick=tick),
        "curve_model": lambda tick: tetraskel.curve_model(mesh, tick=tick),
        "curve_skeleton": lambda tick: tetraskel.curve_skeleton(points, tick=tick),
        "medial_mesh": lambda tick: tetraskel.medial_mesh(model, tick=tick),
        "bezier_skeleton": lambda tick: tetraskel.bezier_skeleton(skeleton, tick=tick),
        "skeleton_surface": lambda tick: tetraskel.skeleton_surface(skeleton, max_cells=3000, tick=tick),
        "surface_error": lambda tick: tetraskel.surface_error(surface, mesh.points, tick=tick),
        **{
            f"voronoi {method}": lambda tick, method=method: tetraskel.voronoi_skeleton(
                mesh, method=method, inside=inside, tick=tick
            )
            for method in ("sk1", "sk2", "sk3", "sk4")
        },
        "rasterise": lambda tick: tetraskel.rasterise(mesh, inside=inside, resolution=24, tick=tick),
        "raster_skeleton": lambda tick: tetraskel.raster_skeleton(mask.values, method="distance", tick=tick),
        "morphological_reversal": lambda tick: tetraskel.morphological_reversal(core, tick=tick),
        "tree_skeleton": lambda tick: tetraskel.tree_skeleton(points, tick=tick),
        "compare": lambda tick: tetraskel.compare(mesh, inside=inside, methods="curve,sk1", resolution=16, tick=tick),
    }  # fmt: skip


class Stopper:
    """A tick that stops a run when it is called for the nth time."""

    def __init__(self, at):
        self.at, self.calls = at, 0

    def __call__(self, share):
        assert -1e-9 <= share <= 1 + 1e-9, share
        self.calls += 1
        if self.calls == self.at:
            raise Aborted("stopped on request.")


@pytest.fixture(scope="module")
def torus():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InsideWarning)
        return stages(TUBES["torus"]().sample(1000))


@pytest.mark.parametrize("share", [0.0, 0.7])
def test_every_stage_can_be_stopped_and_leaves_nothing_behind(torus, share):
    threads, silent = threading.active_count(), []
    for name, stage in torus.items():
        counter = Stopper(0)
        whole = stage(counter)
        if counter.calls == 0:
            silent.append(name)
            continue
        with pytest.raises(Aborted):
            stage(Stopper(max(int(share * counter.calls / 2), 1)))  # how often it is told depends on the time, too
        again = stage(lambda _: None)
        assert same(whole, again), name
    assert not silent
    deadline = threading.Event()
    for _ in range(100):  # a library call that cannot be stopped ends by itself
        if threading.active_count() <= threads:
            break
        deadline.wait(0.1)
    assert threading.active_count() <= threads


def same(first, second):
    """Whether two results are equal to the last bit, as far as they are arrays."""
    if isinstance(first, (list, tuple)):
        return all(same(a, b) for a, b in zip(first, second, strict=True))
    if isinstance(first, np.ndarray):
        return np.array_equal(first, second, equal_nan=first.dtype.kind == "f")
    if isinstance(first, dict):
        return all(same(first[key], second[key]) for key in first if key != "seconds")
    if hasattr(first, "__dataclass_fields__"):
        return all(
            same(getattr(first, name), getattr(second, name))
            for name in first.__dataclass_fields__
            if name != "seconds"
        )
    return True


def test_a_filter_that_is_stopped_has_no_output_and_runs_again():
    source = pyvista.PolyData(TUBES["torus"]().sample(3000))
    made = CurveSkeleton()
    made.SetInputDataObject(0, source)
    stop = made.AddObserver("ProgressEvent", lambda *_: made.SetAbortExecute(1))
    made._shown = -1e9
    with pytest.raises(Aborted):
        made.run()
    assert made.GetOutputDataObject(0).GetNumberOfPoints() == 0
    made.RemoveObserver(stop)
    made.SetAbortExecute(0)
    made.Modified()
    assert made.run().GetNumberOfPoints() > 0
