"""Draw the stages of the two methods on a key in the plane: `python docs/draw_stages.py`.

Everything is what the kernels give at each stage, nothing is drawn by hand. Needs matplotlib, which comes with PyVista.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot
from matplotlib.collections import LineCollection, PolyCollection
from PIL import Image

from tetraskel import (
    assemble_skeleton,
    build_tree,
    curve_model,
    draw_curve,
    interior,
    remove_flat,
    submesh,
    triangulate,
)

PICTURES = Path(__file__).resolve().parent / "pictures"
INK, PALE, INSIDE, OUTSIDE, RED = "#30404f", "#b8c4cf", "#f2c9a1", "#e9edf1", "#c0392b"


def key_points(gap=0.055):
    """Points on the outline of a key: a ring, a shaft and two bits, all of them discs along lines."""
    around = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ring = np.stack([np.cos(around), np.sin(around)], axis=1)
    parts = [(ring, 0.34), (line((0.9, 0), (4.2, 0)), 0.3), (line((3.2, 0), (3.2, -0.75)), 0.22)]
    parts.append((line((4.05, 0), (4.05, -0.55)), 0.22))
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    drawn = np.concatenate([middle + radius * circle for middles, radius in parts for middle in middles])
    away = np.min([away_from(drawn, middles) - radius for middles, radius in parts], axis=0)
    rim = drawn[away > -1e-3]
    kept = []
    for k in np.random.default_rng(1).permutation(len(rim)):  # evenly, and generic
        if not kept or np.min(np.linalg.norm(rim[kept] - rim[k], axis=1)) > gap:
            kept.append(k)
    return rim[kept]


def line(start, end):
    """Points along a line."""
    return np.linspace(start, end, 120)


def away_from(points, middles):
    """Distance to the nearest of the middles."""
    return np.min(np.linalg.norm(points[:, None] - middles[None], axis=2), axis=1)


class Sheet:
    """A small picture of the key; saved when it is left."""

    def __init__(self, name):
        self.name = name

    def __enter__(self):
        self.figure, self.axes = pyplot.subplots(figsize=(4.6, 2.15), dpi=130)
        return self.axes

    def __exit__(self, *_):
        self.axes.set_aspect("equal")
        self.axes.axis("off")
        self.axes.set_xlim(-1.5, 4.65)
        self.axes.set_ylim(-1.45, 1.45)
        self.figure.subplots_adjust(0, 0, 1, 1)
        self.figure.canvas.draw()
        picture = Image.fromarray(np.asarray(self.figure.canvas.buffer_rgba())).convert("RGB")
        picture.quantize(48).save(PICTURES / f"{self.name}.png", optimize=True)  # a third of the size
        pyplot.close(self.figure)


def dots(axes, points, **looks):
    """Points."""
    axes.scatter(*points.T, **{"s": 5, "color": INK, "zorder": 5, "linewidths": 0, **looks})


def edges(axes, points, pairs, values=None, **looks):
    """Lines between pairs of points, in one colour or by values."""
    lines = LineCollection(points[pairs], capstyle="round", **looks)
    if values is not None:
        lines.set_array(values)
        lines.set_cmap("viridis")
    axes.add_collection(lines)


def mesh_of(axes, mesh, fills=None, **looks):
    """Triangles, filled if wanted."""
    looks = {"edgecolors": PALE, "linewidths": 0.6, "facecolors": fills if fills is not None else "none", **looks}
    axes.add_collection(PolyCollection(mesh.points[mesh.simplices], **looks))


def curve_stages(mesh, inside):
    """Points, triangles, inside, nodes, branches by significance, the skeleton with its discs."""
    model = curve_model(mesh)
    inner, nodes, skeleton = submesh(mesh, inside), model.nodes, draw_curve(model)
    with Sheet("stage-points") as axes:
        dots(axes, mesh.points)
    with Sheet("stage-triangles") as axes:
        mesh_of(axes, mesh)
        dots(axes, mesh.points)
    with Sheet("stage-inside") as axes:
        mesh_of(axes, mesh, np.where(inside, INSIDE, OUTSIDE), edgecolors="white", linewidths=0.3)
        dots(axes, mesh.points)
    with Sheet("stage-nodes") as axes:
        mesh_of(axes, inner, edgecolors="#e3d3c2")
        for place, radius in zip(nodes.positions[::14], nodes.radii[::14], strict=True):
            axes.add_patch(pyplot.Circle(place, radius, fill=False, color=PALE, linewidth=0.5))
        dots(axes, nodes.positions, s=8, c=nodes.radii, color=None, cmap="viridis")
        dots(axes, mesh.points, s=2)
    with Sheet("stage-branches") as axes:
        dots(axes, mesh.points, s=2, color=PALE)
        significance = np.log(np.maximum(model.branches.significance, 0.01))
        values = np.repeat(significance, [len(pairs) for pairs in model.branches.edges])
        edges(axes, nodes.positions, np.concatenate(model.branches.edges), values, linewidths=1.4)
        edges(axes, nodes.positions, model.core.edges, colors=RED, linewidths=2.2)
    with Sheet("stage-skeleton") as axes:
        for place, radius in zip(skeleton.points[::2], skeleton.radius[::2], strict=True):
            axes.add_patch(pyplot.Circle(place, radius, fill=False, color=PALE, linewidth=0.5))
        dots(axes, mesh.points, s=2)
        edges(axes, skeleton.points, skeleton.edges, skeleton.radius[skeleton.edges].mean(axis=1), linewidths=2.6)


def tree_stages(mesh, inside):
    """The walk through the inside, the tree without flat nodes, the skeleton without leaves."""
    inner = submesh(mesh, inside)
    tree = build_tree(inner)
    for name, drawn, keep in (
        ("stage-tree", tree, True),
        ("stage-flat", remove_flat(tree, threshold=0.25), True),
        ("stage-leaves", tree, False),
    ):
        skeleton = assemble_skeleton(drawn, keep_leaves=keep)
        with Sheet(name) as axes:
            mesh_of(axes, inner, edgecolors="#e3d3c2")
            sons = np.flatnonzero(skeleton.parent >= 0)
            pairs = np.stack([skeleton.parent[sons], sons], axis=1)
            edges(axes, skeleton.points, pairs, drawn.depth[skeleton.node[sons]], linewidths=1.6)
            dots(axes, mesh.points, s=2)


if __name__ == "__main__":
    mpl.use("Agg")
    key = triangulate(key_points())
    inside = interior(key)
    curve_stages(key, inside)
    tree_stages(key, inside)
