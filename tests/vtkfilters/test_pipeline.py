"""The filters as classes of VTK: pipelines by `>>`, keywords, properties, pickling, help."""

from __future__ import annotations

import inspect
import pickle
import pydoc
from dataclasses import fields, is_dataclass

import numpy as np
import pytest
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkPointSource, vtkSphereSource

import tetraskel
from tetraskel import InputError, assemble_skeleton, build_tree, triangulate
from tetraskel import vtkfilters as package
from tetraskel.vtkfilters import DelaunayMesh, SkeletonOutput, TreeBuilder
from tetraskel.vtkfilters.base import camel_case
from tetraskel.vtkfilters.convert import points_of, to_points

FILTERS = [getattr(package, name) for name in package.__all__ if name != "SkeletonFilter"]
POINTS = np.random.default_rng(0).random((60, 3))
pipelines = pytest.mark.skipif(not hasattr(vtkSphereSource, "__rshift__"), reason="VTK 9.4 and later")


def cloud(points=POINTS):
    data = vtkPolyData()
    data.SetPoints(to_points(points))
    return data


@pipelines
def test_filters_are_chained_behind_a_source():
    source = vtkSphereSource()
    pipeline = source >> DelaunayMesh() >> TreeBuilder(traversal="depth") >> SkeletonOutput()
    output = pipeline.update().output
    mesh = triangulate(points_of(source.GetOutput()))
    assert np.array_equal(points_of(output), assemble_skeleton(build_tree(mesh, traversal="depth")).points)
    assert points_of(pipeline.last.run()).shape == points_of(output).shape


@pipelines
def test_filters_are_chained_behind_data():
    pipeline = cloud() >> DelaunayMesh() >> TreeBuilder()
    assert points_of(pipeline.update().output).shape == (len(triangulate(POINTS)), 3)


@pipelines
def test_a_pipeline_is_a_function_of_data():
    skeleton = DelaunayMesh() >> TreeBuilder() >> SkeletonOutput()
    for part in (POINTS, POINTS[:20]):
        found = points_of(skeleton(cloud(part)))
        assert np.array_equal(found, assemble_skeleton(build_tree(triangulate(part))).points)


@pipelines
def test_an_error_of_a_pipeline_is_raised_by_run(messages):
    source = vtkPointSource()
    source.SetNumberOfPoints(1)
    pipeline = source >> DelaunayMesh() >> TreeBuilder()
    with pytest.raises(InputError, match="expected at least 3 distinct points"):
        pipeline.last.run()
    source.SetNumberOfPoints(50)
    assert pipeline.last.run().GetNumberOfPoints() > 0


@pytest.mark.parametrize("kind", FILTERS)
def test_options_are_keywords_and_properties(kind):
    for declared in fields(kind.options):
        made = kind(**{declared.name: declared.default})
        before = made.GetMTime()
        setattr(made, declared.name, declared.default)
        assert made.GetMTime() == before  # nothing has changed, nothing is computed again
        assert getattr(made, declared.name) == declared.default


@pytest.mark.parametrize("kind", FILTERS)
def test_a_misspelt_option_is_refused(kind):
    for declared in fields(kind.options):
        wrong = declared.name + "s"
        with pytest.raises(AttributeError, match=f"{kind.__name__} has no option '{wrong}'; it has: "):
            kind(**{wrong: declared.default})
        with pytest.raises(AttributeError, match=f"no option '{wrong}'"):
            setattr(kind(), wrong, declared.default)


@pytest.mark.parametrize("kind", FILTERS)
def test_help_tells_every_option(kind):
    text = pydoc.plain(pydoc.render_doc(kind))
    assert kind.__doc__.splitlines()[0] in text
    assert f"class {kind.__name__}" in text
    keywords = inspect.signature(kind).parameters
    assert list(keywords) == [declared.name for declared in fields(kind.options)]
    for declared in fields(kind.options):
        assert keywords[declared.name].default == declared.default
        doc = declared.metadata["doc"]
        for member in (declared.name, f"Set{camel_case(declared.name)}", f"Get{camel_case(declared.name)}"):
            assert inspect.getdoc(getattr(kind, member)) == doc
        assert doc.split(". ")[0] in text


def results():
    """Results of the kernels, one of each kind that is public."""
    around, across = np.random.default_rng(0).random((2, 1600)) * 2 * np.pi
    out = 2 + 0.8 * np.cos(across)
    torus = np.stack([out * np.cos(around), out * np.sin(around), 0.8 * np.sin(across)], axis=1)
    mesh = triangulate(torus)
    inside = tetraskel.interior(mesh)
    tree = build_tree(mesh)
    model = tetraskel.curve_model(mesh)
    skeleton = tetraskel.draw_curve(model)
    mask = tetraskel.rasterise(mesh, inside=inside, resolution=12)
    return [
        mesh,
        tree,
        model,
        skeleton,
        mask,
        tetraskel.denoised(torus),
        tetraskel.thinned(torus, most_points=500),
        tetraskel.binarize(tree),
        tetraskel.gate_tree(mesh),
        tetraskel.medial_mesh(model),
        assemble_skeleton(tree),
        tetraskel.bezier_skeleton(skeleton),
        tetraskel.skeleton_surface(skeleton),
        tetraskel.voronoi_skeleton(mesh, inside=inside),
        tetraskel.raster_skeleton(mask.values, method="distance"),
        *tetraskel.compare(mesh, methods="sk1"),
    ]


def test_results_of_the_kernels_can_be_pickled():
    made = results()
    public = {value for value in vars(tetraskel).values() if inspect.isclass(value) and is_dataclass(value)}
    assert public <= {type(result) for result in made}
    for result in made:
        assert_equal(pickle.loads(pickle.dumps(result)), result)


def assert_equal(again, result):
    """Equal in type and, array by array, in content."""
    assert type(again) is type(result)
    if is_dataclass(result):
        for declared in fields(result):
            assert_equal(getattr(again, declared.name), getattr(result, declared.name))
    elif isinstance(result, np.ndarray):
        assert result.dtype == again.dtype
        assert np.array_equal(again, result, equal_nan=result.dtype.kind == "f")
    elif isinstance(result, (tuple, list)):
        for one, other in zip(again, result, strict=True):
            assert_equal(one, other)
    else:
        assert again == result
