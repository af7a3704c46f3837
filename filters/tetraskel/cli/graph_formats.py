"""Skeletons as graphs in the formats other programs read: SWC, GraphML, CSV, PLY with edges."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.errors import InputError
from tetraskel.kernels.branch_table import COLUMNS, branch_table
from tetraskel.vtkfilters.convert import array_of, points_of, segments_of

RADII = ("MaximumInscribedSphereRadius", "Radius")  # of a curve skeleton, of a tree's nodes


def write_swc(data: vtkPolyData, path: Path) -> None:
    """Parents first, ids from 1, radius (not diameter), root -1; comments name the edges that close loops.

    SWC holds trees only, so a loop is cut at its farthest point from the root and the edge left out is said.
    """
    points, radius = points_of(data), _radius(data)
    parent, depth = _parents(data), array_of(data.GetPointData(), "Depth")
    order = np.lexsort((np.arange(len(points)), depth))
    number = np.full(len(points) + 1, -1)
    number[order] = np.arange(1, len(points) + 1)
    loops = _edges_beside(parent, segments_of(data.GetLines(), closed=False))
    lines = ["# tetraskel skeleton: id type x y z radius parent"]
    lines += [f"# loop closed by the edge {number[a]} {number[b]}, which SWC cannot hold" for a, b in loops]
    for node in order.tolist():
        x, y, z = points[node].tolist()
        kind = 1 if parent[node] < 0 else 0
        lines.append(f"{number[node]} {kind} {x!r} {y!r} {z!r} {float(radius[node])!r} {number[parent[node]]}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _parents(data: vtkPolyData) -> np.ndarray:
    """Index of each point's parent: `ParentId` says it by the numbers of `NodeId`."""
    parent, node = (array_of(data.GetPointData(), name) for name in ("ParentId", "NodeId"))
    if parent is None or array_of(data.GetPointData(), "Depth") is None:
        raise InputError("expected a skeleton with the arrays ParentId and Depth for SWC, got none.")
    if node is None:
        return parent
    index = np.full(int(node.max(initial=0)) + 2, -1)
    index[node] = np.arange(len(node))
    return index[parent]


def _edges_beside(parent: np.ndarray, edges: np.ndarray) -> list[tuple[int, int]]:
    """Edges that do not join a point with its parent."""
    beside = (parent[edges[:, 0]] != edges[:, 1]) & (parent[edges[:, 1]] != edges[:, 0])
    return [(int(a), int(b)) for a, b in edges[beside]]


def _radius(data: vtkPolyData) -> np.ndarray:
    for name in RADII:
        values = array_of(data.GetPointData(), name)
        if values is not None:
            return np.where(np.isfinite(values), values, 0.0)
    return np.zeros(data.GetNumberOfPoints())


def point_columns(data: vtkPolyData) -> dict[str, np.ndarray]:
    """Every numeric point array by name; those with more components as name_0, name_1, ..."""
    columns: dict[str, np.ndarray] = {}
    attributes = data.GetPointData()
    for k in range(attributes.GetNumberOfArrays()):
        name = attributes.GetArrayName(k)
        values = array_of(attributes, name)
        if values is None:
            continue
        columns |= {name: values} if values.ndim == 1 else {f"{name}_{i}": column for i, column in enumerate(values.T)}
    return columns


def write_csv(data: vtkPolyData, path: Path) -> None:
    """One row per point: coordinates, then every point array."""
    x, y, z = points_of(data).T
    _write_rows(path, {"x": x, "y": y, "z": z, **point_columns(data)})


def write_edges_csv(data: vtkPolyData, path: Path) -> None:
    """One row per edge: the rows of its points in the table of the points, from 0."""
    start, end = segments_of(data.GetLines(), closed=False).T
    _write_rows(path, {"start": start, "end": end})


def write_branch_table(data: vtkPolyData, path: Path) -> None:
    """One row per branch, with the columns of `tetraskel.kernels.branch_table`."""
    lines = data.GetLines()
    offsets, ids = (vtk_to_numpy(array) for array in (lines.GetOffsetsArray(), lines.GetConnectivityArray()))
    rows = branch_table(points_of(data), _radius(data), offsets, ids)
    text = [",".join(map(str, row)) for row in [COLUMNS, *rows]]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")


def _write_rows(path: Path, columns: dict[str, np.ndarray]) -> None:
    with path.open("w", encoding="utf-8") as stream:
        stream.write(",".join(columns) + "\n")
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            stream.write(",".join(map(repr, row)) + "\n")


def write_ply(data: vtkPolyData, path: Path) -> None:
    """ASCII PLY with a vertex element (x, y, z, radius) and an edge element (vertex1, vertex2)."""
    points, radius, edges = points_of(data), _radius(data), segments_of(data.GetLines(), closed=False)
    header = ["ply", "format ascii 1.0", "comment tetraskel skeleton", f"element vertex {len(points)}"]
    header += [f"property double {name}" for name in ("x", "y", "z", "radius")]
    header += [f"element edge {len(edges)}", "property int vertex1", "property int vertex2", "end_header"]
    body = [" ".join(map(repr, row)) for row in np.column_stack([points, radius]).tolist()]
    body += [f"{a} {b}" for a, b in edges.tolist()]
    path.write_text("\n".join(header + body) + "\n", encoding="utf-8")


def write_graphml(data: vtkPolyData, path: Path) -> None:
    """GraphML with x, y, z and every point array on the nodes."""
    x, y, z = points_of(data).T
    columns = {"x": x, "y": y, "z": z, **point_columns(data)}
    kinds = {name: "double" if column.dtype.kind == "f" else "long" for name, column in columns.items()}
    with path.open("w", encoding="utf-8") as stream:
        stream.write(
            '<?xml version="1.0" encoding="UTF-8"?>\n<graphml xmlns="http://graphml.graphdrawing.org/xmlns">\n'
        )
        for k, (name, kind) in enumerate(kinds.items()):
            stream.write(f'<key id="d{k}" for="node" attr.name={quoteattr(name)} attr.type="{kind}"/>\n')
        stream.write('<graph edgedefault="undirected">\n')
        for node, row in enumerate(zip(*(column.tolist() for column in columns.values()), strict=True)):
            values = "".join(f'<data key="d{k}">{value!r}</data>' for k, value in enumerate(row))
            stream.write(f'<node id="n{node}">{values}</node>\n')
        for start, end in segments_of(data.GetLines(), closed=False).tolist():
            stream.write(f'<edge source="n{start}" target="n{end}"/>\n')
        stream.write("</graph>\n</graphml>\n")
