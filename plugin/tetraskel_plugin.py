"""The tetraskel plugin for ParaView: Tools > Manage Plugins > Load New, and the filters are under Skeleton Tree.

Declarations only. The filters come from the package beside this file: `../filters/tetraskel` in a checkout, the folder
above in an installation. It is loaded from there by its path; nothing else of an environment gets onto ParaView's path,
where a second VTK would end the program.
"""

import importlib.util
import os
import sys

if sys.version_info < (3, 10):  # noqa: UP036  (ParaView chooses the Python, not an installer)
    raise ImportError(
        "tetraskel needs a ParaView with Python 3.10 or later, as 5.12 and later have; "
        f"this one has Python {sys.version_info[0]}.{sys.version_info[1]}."
    )


def _load_package():
    """Import tetraskel from beside this file, or from wherever Python finds it."""
    here = os.path.dirname(os.path.realpath(__file__))
    for folder in (os.path.join(os.path.dirname(here), "filters", "tetraskel"), os.path.dirname(here)):
        start = os.path.join(folder, "__init__.py")
        if "tetraskel" not in sys.modules and os.path.basename(folder) == "tetraskel" and os.path.isfile(start):
            spec = importlib.util.spec_from_file_location("tetraskel", start, submodule_search_locations=[folder])
            sys.modules["tetraskel"] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(sys.modules["tetraskel"])
    return importlib.import_module("tetraskel")


tetraskel = _load_package()

from paraview.util.vtkAlgorithm import smhint, smproperty, smproxy  # noqa: E402

from tetraskel import vtkfilters  # noqa: E402
from tetraskel.vtkfilters.paraview_display import give_defaults, representation  # noqa: E402
from tetraskel.vtkfilters.paraview_xml import hints_xml, label, panel_xml  # noqa: E402

paraview_plugin_name = "tetraskel"
paraview_plugin_version = tetraskel.__version__

give_defaults()


@smproxy.source(**representation("SkeletonLines"))
class SkeletonLines:
    """Lines as tubes."""


@smproxy.source(**representation("SkeletonThinLines"))
class SkeletonThinLines:
    """Many lines as thin tubes."""


@smproxy.source(**representation("SkeletonCloud"))
class SkeletonCloud:
    """Points through which a skeleton can be seen."""


@smproxy.filter(name="CurveSkeleton", label=label("CurveSkeleton"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.CurveSkeleton))
@smproperty.xml(panel_xml(vtkfilters.CurveSkeleton))
class CurveSkeleton(vtkfilters.CurveSkeleton):
    """Points, or a mesh with its inside, to the curve skeleton."""


@smproxy.filter(name="PointThinning", label=label("PointThinning"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.PointThinning))
@smproperty.xml(panel_xml(vtkfilters.PointThinning))
class PointThinning(vtkfilters.PointThinning):
    """Points of a surface to fewer of them."""


@smproxy.filter(name="DelaunayMesh", label=label("DelaunayMesh"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.DelaunayMesh))
@smproperty.xml(panel_xml(vtkfilters.DelaunayMesh))
class DelaunayMesh(vtkfilters.DelaunayMesh):
    """Points to Delaunay tetrahedra or triangles."""


@smproxy.filter(name="InteriorCells", label=label("InteriorCells"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.InteriorCells))
@smproperty.xml(panel_xml(vtkfilters.InteriorCells))
class InteriorCells(vtkfilters.InteriorCells):
    """Mesh with its inside marked."""


@smproxy.filter(name="TreeBuilder", label=label("TreeBuilder"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.TreeBuilder))
@smproperty.xml(panel_xml(vtkfilters.TreeBuilder))
class TreeBuilder(vtkfilters.TreeBuilder):
    """Mesh to the binary or ternary tree of its cells."""


@smproxy.filter(name="FlatTetraRemoval", label=label("FlatTetraRemoval"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.FlatTetraRemoval))
@smproperty.xml(panel_xml(vtkfilters.FlatTetraRemoval))
class FlatTetraRemoval(vtkfilters.FlatTetraRemoval):
    """Tree or mesh without its flat simplices."""


@smproxy.filter(name="SkeletonOutput", label=label("SkeletonOutput"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.SkeletonOutput))
@smproperty.xml(panel_xml(vtkfilters.SkeletonOutput))
class SkeletonOutput(vtkfilters.SkeletonOutput):
    """Tree to skeleton."""


@smproxy.filter(name="SkeletonSurface", label=label("SkeletonSurface"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.SkeletonSurface))
@smproperty.xml(panel_xml(vtkfilters.SkeletonSurface))
class SkeletonSurface(vtkfilters.SkeletonSurface):
    """Skeleton with radii back to the surface of its object."""


@smproxy.filter(name="BezierSkeleton", label=label("BezierSkeleton"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.BezierSkeleton))
@smproperty.xml(panel_xml(vtkfilters.BezierSkeleton))
class BezierSkeleton(vtkfilters.BezierSkeleton):
    """Skeleton with radii to smooth curves."""


@smproxy.filter(name="VoronoiSkeleton", label=label("VoronoiSkeleton"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.VoronoiSkeleton))
@smproperty.xml(panel_xml(vtkfilters.VoronoiSkeleton))
class VoronoiSkeleton(vtkfilters.VoronoiSkeleton):
    """Points, or a mesh with its inside, to a Voronoi skeleton."""


@smproxy.filter(name="RasterSkeleton", label=label("RasterSkeleton"), support_reload=False)
@smhint.xml(hints_xml(vtkfilters.RasterSkeleton))
@smproperty.xml(panel_xml(vtkfilters.RasterSkeleton))
class RasterSkeleton(vtkfilters.RasterSkeleton):
    """A mask, or what is made into one, to its skeleton."""
