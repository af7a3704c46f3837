"""All skeletons of the active source, side by side: a macro for ParaView.

Load the plugin, choose points in the pipeline browser (or a mesh with an array Inside), and run it; *Macros > Import
new macro* puts it into a menu. Every method gets a view of its own in a new layout, with the points around it. All
views turn together, and the pipeline entries are named after the methods. A method that draws nothing has a view that
says so; why is in the output messages. A colour is the same radius in every view; the tree is coloured by depth.
"""

import math

from paraview import simple

LEAST_ANGLE = 0.0  # degrees; Voronoi elements seen at less are left out
RESOLUTION = 128  # grid points along the longest side, for the skeletons of masks
COLUMNS, ROWS = 5, 2
NARROW = 0.7  # of a view's height may be its width: ten views in one window are narrow, and have no size yet
VIEW_ANGLE = 30.0  # degrees, from top to bottom
RADIUS = "MaximumInscribedSphereRadius"


def compare_skeletons(source):
    """Draw all skeletons of a source; gives the filters by the name of their method."""
    drawn = skeletons_of(source)
    layout = simple.CreateLayout("Skeletons")
    views = grid_of_views(layout)
    for view, (name, skeleton) in zip(views, drawn.items(), strict=True):
        show(view, source, name, skeleton)
    widest = drawn["curve"].PointData.GetArray(RADIUS)
    if widest is not None:  # some circumcentres of Sk4 lie outside, with radii that would make all else look alike
        simple.GetColorTransferFunction(RADIUS).RescaleTransferFunction(0.0, widest.GetRange()[1])
    for view in views[1:]:
        simple.AddCameraLink(views[0], view, "tetraskel " + str(view.SMProxy.GetGlobalIDAsString()))
    look_at(views, source)
    simple.SetActiveSource(source)
    return drawn


def skeletons_of(source):
    """The filters, in the order of the command line's table; they share one mesh and one inside."""
    simple.UpdatePipeline(proxy=source)
    if source.CellData.GetArray("Inside") is not None:
        inside = source
    else:
        mesh = filter_named("DelaunayMesh")(registrationName="compare: mesh", Input=source, Denoise=1)
        inside = filter_named("InteriorCells")(registrationName="compare: inside", Input=mesh)
    kept = filter_named("InteriorCells")(
        registrationName="compare: inside only", Input=inside, Method="Array", Extract=1
    )
    tree = filter_named("TreeBuilder")(registrationName="compare: tree of all", Input=kept)
    flat = filter_named("FlatTetraRemoval")(registrationName="compare: without flat", Input=tree)
    drawn = {
        "curve": filter_named("CurveSkeleton")(registrationName="curve", Input=inside),
        "tree": filter_named("SkeletonOutput")(registrationName="tree", Input=flat),
    }
    for method in ("Sk1", "Sk2", "Sk3", "Sk4"):
        name = method.lower()
        drawn[name] = filter_named("VoronoiSkeleton")(
            registrationName=name, Input=inside, Method=method, LeastAngle=LEAST_ANGLE
        )
    for method in ("Morphological", "Thinning", "Distance"):
        name = method.lower()
        drawn[name] = filter_named("RasterSkeleton")(
            registrationName=name, Input=inside, Method=method, Resolution=RESOLUTION
        )
    drawn["bezier"] = filter_named("BezierSkeleton")(registrationName="bezier", Input=drawn["curve"])
    return drawn


def filter_named(name):
    """What makes a filter of the plugin, loaded before `paraview.simple` was imported or after it."""
    if not hasattr(simple, name) and hasattr(simple, "_add_functions"):
        simple._add_functions(vars(simple))
    found = getattr(simple, name, None) or globals().get(name)
    if found is None:
        raise RuntimeError("expected the tetraskel plugin, which is not loaded; see Tools > Manage Plugins.")
    return found


def grid_of_views(layout):
    """Render views in rows and columns of equal size, row after row."""
    rows = split(layout, 0, ROWS, vertical=True)
    cells = [cell for row in rows for cell in split(layout, row, COLUMNS, vertical=False)]
    views = []
    for cell in cells:
        view = simple.CreateView("RenderView")
        view.UseColorPaletteForBackground = 0
        view.Background = [1.0, 1.0, 1.0]
        view.OrientationAxesVisibility = 0
        layout.AssignView(cell, view)
        views.append(view)
    return views


def split(layout, cell, parts, vertical):
    """Cut a cell of the layout into equal parts; gives their numbers in order."""
    cells = []
    for left in range(parts, 1, -1):
        cut = layout.SplitVertical if vertical else layout.SplitHorizontal
        first = cut(cell, 1.0 / left)
        cells.append(first)
        cell = first + 1
    return [*cells, cell]


def show(view, source, name, skeleton):
    """A skeleton among the points of the source, coloured by radius, with its name above it."""
    simple.UpdatePipeline(proxy=skeleton)
    n_points = skeleton.GetDataInformation().GetNumberOfPoints()
    around = simple.Show(source, view)
    around.SetRepresentationType("Points")
    around.ColorArrayName = ["POINTS", ""]
    around.AmbientColor = around.DiffuseColor = [0.36, 0.42, 0.48]
    around.Opacity = 0.15
    if n_points:
        lines = simple.Show(skeleton, view)
        few = n_points < 2000
        lines.LineWidth = 4.0 if few else 1.0
        lines.PointSize = 5.0 if few else 2.0
        coloured = RADIUS if skeleton.PointData.GetArray(RADIUS) is not None else "Depth"
        simple.ColorBy(lines, ("POINTS", coloured))
        lines.SetScalarBarVisibility(view, False)
    title = simple.Text(registrationName="compare: title of " + name)
    title.Text = f"{name} ({n_points:,} points)" if n_points else name + ": nothing drawn"
    written = simple.Show(title, view)
    place = written.GetProperty("WindowLocation")  # words before ParaView 5.12 had no blank
    written.WindowLocation = next(word for word in place.Available if word.replace(" ", "") == "UpperCenter")
    written.Color = [0.0, 0.0, 0.0]
    written.FontSize = 10


def look_at(views, source):
    """One camera for all: from the front and above, or straight down on what is flat."""
    bounds = source.GetDataInformation().GetBounds()
    centre = [(bounds[k] + bounds[k + 1]) / 2 for k in (0, 2, 4)]
    reach = sum((bounds[k + 1] - bounds[k]) ** 2 for k in (0, 2, 4)) ** 0.5 / 2
    flat = bounds[4] == bounds[5]
    way, up = ([0, 0, 1], [0, 1, 0]) if flat else ([1, -2, 1.4], [0, 0, 1])
    half = math.atan(NARROW * math.tan(math.radians(VIEW_ANGLE) / 2))  # of the angle from left to right
    away = reach / math.sin(half) / math.hypot(*way)
    for view in views:
        view.CameraFocalPoint = centre
        view.CameraPosition = [c + away * w for c, w in zip(centre, way, strict=True)]
        view.CameraViewUp = up
        view.CameraViewAngle = VIEW_ANGLE
        simple.Render(view)


active = simple.GetActiveSource()
if active is None:
    raise RuntimeError("expected a source chosen in the pipeline browser, got none; open points and select them.")
compare_skeletons(active)
