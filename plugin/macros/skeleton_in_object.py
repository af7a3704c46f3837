"""The curve skeleton of the active source inside the object's boundary: a macro for ParaView.

Load the plugin, choose points in the pipeline browser, and run it; *Macros > Import new macro* puts it into a menu. The
boundary is found from the points alone and is drawn so that the skeleton can be seen through it.
"""

from paraview import simple

DETAIL = 0.5
OPACITY = 0.3


def skeleton_in_object(source):
    """Draw the skeleton and the boundary; gives both filters."""
    view = simple.GetActiveViewOrCreate("RenderView")
    mesh = filter_named("DelaunayMesh")(registrationName="mesh", Input=source)
    inside = filter_named("InteriorCells")(registrationName="inside", Input=mesh)
    skeleton = filter_named("CurveSkeleton")(registrationName="skeleton", Input=inside, Detail=DETAIL)
    simple.Hide(source, view)
    boundary = simple.Show(simple.OutputPort(inside, 1), view)
    boundary.Opacity = OPACITY
    boundary.ColorArrayName = ["POINTS", ""]
    lines = simple.Show(skeleton, view)
    lines.LineWidth = 6.0
    simple.ColorBy(lines, ("POINTS", "MaximumInscribedSphereRadius"))
    lines.SetScalarBarVisibility(view, True)
    simple.ResetCamera(view)
    simple.Render(view)
    simple.SetActiveSource(skeleton)
    return inside, skeleton


def filter_named(name):
    """What makes a filter of the plugin, loaded before `paraview.simple` was imported or after it."""
    if not hasattr(simple, name) and hasattr(simple, "_add_functions"):
        simple._add_functions(vars(simple))
    found = getattr(simple, name, None) or globals().get(name)
    if found is None:
        raise RuntimeError("expected the tetraskel plugin, which is not loaded; see Tools > Manage Plugins.")
    return found


active = simple.GetActiveSource()
if active is None:
    raise RuntimeError("expected a source chosen in the pipeline browser, got none; open points and select them.")
skeleton_in_object(active)
