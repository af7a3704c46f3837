"""Every filter as a method of PyVista's data sets: `mesh.tetraskel.skeleton(detail=0.3)`.

An installed tetraskel is found by PyVista 0.48 and later without an import; before that, or in a checkout,
`import tetraskel.pyvista_accessor` registers it.
"""

from __future__ import annotations

import inspect
import textwrap
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from itertools import pairwise

import pyvista
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from tetraskel.errors import InputError
from tetraskel.vtkfilters import (
    BezierSkeleton,
    CurveSkeleton,
    DelaunayMesh,
    FlatTetraRemoval,
    InteriorCells,
    PointThinning,
    RasterSkeleton,
    SkeletonFilter,
    SkeletonOutput,
    SkeletonSurface,
    TreeBuilder,
    VoronoiSkeleton,
)
from tetraskel.vtkfilters.convert import holds_simplices
from tetraskel.vtkfilters.progress import ProgressLine

NAME = "tetraskel"
LINE = 96
PROGRESS = ("progress_bar", False, "bool, default: False", "Draw a line of progress on standard error.")


def _method(*chain: type[SkeletonFilter], shown: str | None = None):
    """The method that runs `chain` on a data set and gives the last one's result, with `shown` as active scalars.

    Filters before the last one prepare points and are left out where the data set is a mesh to be taken as it is.
    """
    signature = _signature(chain)

    def method(self, /, **keywords):
        unknown = [name for name in keywords if name not in signature.parameters]
        if unknown:
            known = ", ".join(list(signature.parameters)[1:])
            raise TypeError(f"{method.__name__}() has no option {unknown[0]!r}; it has: {known}.")
        return _run(self._data, chain, shown, keywords)

    method.chain = chain
    method.__signature__ = signature
    method.__doc__ = _documentation(chain)
    return method


def _options(chain) -> list:
    return [declared for cls in chain for declared in fields(cls.options)]


def _extras(cls: type[SkeletonFilter]) -> list[tuple]:
    """Name, default, type and meaning of what a method takes beside its options."""
    extras = []
    if cls.second_input:
        name, _, kind, meaning = cls.second_input
        extras.append((name.lower(), None, f"pyvista.{kind.removeprefix('vtk')}, optional", meaning))
    if cls.output_names:
        words = [word.lower() for word in cls.output_names]
        meaning = "Which of the filter's outputs comes back."
        extras.append(("output", words[0], f"{{{', '.join(map(repr, words))}}}, default: {words[0]!r}", meaning))
    return [*extras, PROGRESS]


def _signature(chain) -> inspect.Signature:
    pairs = [(declared.name, declared.default) for declared in _options(chain)]
    pairs += [(name, default) for name, default, _, _ in _extras(chain[-1])]
    keywords = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=value) for name, value in pairs]
    return inspect.Signature([inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY), *keywords])


def _documentation(chain) -> str:
    cls = chain[-1]
    lines = [inspect.cleandoc(cls.__doc__), "", "Parameters", "----------"]
    for declared in _options(chain):
        metadata = declared.metadata
        unit = f" [{metadata['unit']}]" if metadata["unit"] else ""
        lines += _parameter(declared.name, _kind(declared), metadata["doc"] + unit)
    for name, _, kind, meaning in _extras(cls):
        lines += _parameter(name, kind, meaning)
    lines += ["", "Returns", "-------", "pyvista.DataSet", f"    What `tetraskel.vtkfilters.{cls.__name__}` makes."]
    lines += ["", "Raises", "------", "TetraskelError"]
    lines += ["    With one sentence: what was expected, what came and what to do."]
    return "\n".join(lines)


def _kind(declared) -> str:
    choices, default = declared.metadata["choices"], declared.default
    kind = "{" + ", ".join(map(repr, choices)) + "}" if choices else type(default).__name__
    return f"{kind}, default: {default!r}"


def _parameter(name: str, kind: str, meaning: str) -> list[str]:
    return [f"{name} : {kind}", *textwrap.wrap(meaning, LINE, initial_indent="    ", subsequent_indent="    ")]


class TetraskelAccessor:
    """Skeletons of a data set: its points, the mesh it holds, or the skeleton it is.

    The options are those of the filters in `tetraskel.vtkfilters`, by keyword. Points are triangulated first where a
    method needs a mesh; an unstructured grid of tetrahedra or of triangles is taken as it is.
    """

    def __init__(self, data: pyvista.DataSet):
        self._data = data

    skeleton = _method(CurveSkeleton)
    delaunay = _method(DelaunayMesh)
    interior = _method(DelaunayMesh, InteriorCells, shown="Inside")
    tree = _method(DelaunayMesh, TreeBuilder, shown="Depth")
    remove_flat = _method(FlatTetraRemoval, shown="Depth")
    branches = _method(SkeletonOutput, shown="Depth")
    voronoi = _method(VoronoiSkeleton)
    raster = _method(RasterSkeleton)
    bezier = _method(BezierSkeleton)
    surface = _method(SkeletonSurface)
    thin = _method(PointThinning)


for _name, _made in vars(TetraskelAccessor).items():
    if hasattr(_made, "chain"):
        _made.__name__, _made.__qualname__ = _name, f"TetraskelAccessor.{_name}"


def _run(data, chain, shown: str | None, given: dict):
    """What the last filter of a chain makes of a data set."""
    last = chain[-1]
    extras = {name: given.get(name, default) for name, default, _, _ in _extras(last)}
    steps = [_made_filter(cls, given) for cls in chain]
    port = _port(last, extras.get("output"))
    if last.second_input and extras[last.second_input[0].lower()] is not None:
        steps[-1].SetInputDataObject(1, extras[last.second_input[0].lower()])
    _execute(data, steps[-1:] if holds_simplices(data) else steps, always=extras["progress_bar"])
    result = pyvista.wrap(steps[-1].GetOutputDataObject(port))
    if shown in result.array_names:
        result.set_active_scalars(shown)
    return result


def _made_filter(cls: type[SkeletonFilter], given: dict) -> SkeletonFilter:
    """A filter with those of the given values that are its options."""
    return cls(**{declared.name: given[declared.name] for declared in fields(cls.options) if declared.name in given})


def _port(cls, word: str | None) -> int:
    """The number of an output's name."""
    words = [name.lower() for name in cls.output_names]
    if words and word not in words:
        raise InputError(f"output must be one of {', '.join(words)}; got {word!r}.")
    return words.index(word) if words else 0


def _execute(data, steps, *, always: bool) -> None:
    """Run the filters one after another; errors are raised, a filter's warnings become Python's."""
    steps[0].SetInputDataObject(0, data)
    for before, after in pairwise(steps):
        after.SetInputConnection(0, before.GetOutputPort())
    with _messages() as window, ProgressLine(always=always) as line:
        if always:
            for step in steps:
                line.watch(step)
        steps[-1].run()
    for message in filter(None, window.GetOutput().splitlines()):
        warnings.warn(message, stacklevel=4)


@contextmanager
def _messages() -> Iterator[vtkStringOutputWindow]:
    """Catch what VTK would print."""
    before, window = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    try:
        yield window
    finally:
        vtkOutputWindow.SetInstance(before)


if hasattr(pyvista, "register_dataset_accessor"):
    pyvista.register_dataset_accessor(NAME, pyvista.DataSet)(TetraskelAccessor)
else:  # before PyVista 0.48
    setattr(pyvista.DataSet, NAME, property(TetraskelAccessor))
