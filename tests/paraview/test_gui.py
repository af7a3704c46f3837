"""The plugin in a ParaView window, driven by its own widgets on a virtual screen."""

from __future__ import annotations

import numpy as np
import pytest

from paths import PLUGIN, SAMPLES

pyvista = pytest.importorskip("pyvista")

WINDOW = "pqClientMainWindow"
PANEL = f"{WINDOW}/propertiesDock/propertiesPanel"
MENU = "Skeleton Tree"


def event(target, command, arguments=""):
    return f'<pqevent object="{target}" command="{command}" arguments="{arguments}" />'


APPLY = event(f"{PANEL}/Accept", "activate")


def choose_filter(name):
    bar = f"{WINDOW}/menubar"
    return "\n".join(
        [
            event(bar, "activate", "menuFilters"),
            event(f"{bar}/menuFilters", "activate", MENU),
            event(f"{bar}/menuFilters/{MENU}", "activate", name),
        ]
    )


def chain(*names):
    return "\n".join(f"{choose_filter(name)}\n{APPLY}" for name in names)


OPEN = f"""
cloud = XMLPolyDataReader(registrationName="cloud", FileName={str(SAMPLES / "torus.vtp")!r})
Show(cloud)
SetActiveSource(cloud)
"""
DRAW = """
skeleton = SkeletonOutput(Input=FlatTetraRemoval(Input=TreeBuilder(Input=DelaunayMesh(Input=cloud))))
shown = Show(skeleton)
ColorBy(shown, ("POINTS", "Depth"))
Render()
ResetCamera()
SaveScreenshot("drawn.png", ImageResolution=[800, 600])
"""


def check(widget, value, what="text"):
    return f'<pqcheck object="{widget}" property="{what}" arguments="{value}" />'


PROPERTIES = f"{PANEL}/scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/PropertiesFrame/ProxyPanel"


def test_filters_are_in_the_menu_and_the_chain_is_applied(paraview):
    threshold = f"{PROPERTIES}/Threshold/DoubleRangeWidget/DoubleLineEdit"
    events = "\n".join(
        [
            chain("DelaunayMesh", "TreeBuilder"),
            choose_filter("FlatTetraRemoval"),
            check(threshold, "0.01"),
            event(threshold, "set_string", "0.2"),
            APPLY,
            check(threshold, "0.2"),
            chain("SkeletonOutput"),
            check(f"{PANEL}/Accept", "false", "enabled"),
        ]
    )
    done = paraview(events, script=OPEN, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_curve_skeleton_is_one_click_and_a_slider(paraview):
    detail = f"{PROPERTIES}/Detail/DoubleRangeWidget/DoubleLineEdit"
    events = [
        choose_filter("CurveSkeleton"),
        check(detail, "0.5"),
        APPLY,
        event(detail, "set_string", "0.9"),
        APPLY,
        check(f"{PANEL}/Accept", "false", "enabled"),
    ]
    done = paraview("\n".join(events), script=OPEN, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_skeleton_is_drawn(paraview, tmp_path):
    done = paraview("", script=OPEN + DRAW, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.returncode == 0, done.stdout + done.stderr
    picture = pyvista.read(tmp_path / "drawn.png").point_data.active_scalars
    assert len(np.unique(np.asarray(picture), axis=0)) > 50


def test_a_broken_plugin_is_noticed(paraview, tmp_path):
    """The test above can fail: with a plugin that does not load, its menu is not there."""
    broken = tmp_path / "plugins"
    broken.mkdir()
    (broken / PLUGIN.name).write_text("raise ImportError('broken on purpose')\n")
    done = paraview(chain("DelaunayMesh"), script=OPEN, PV_PLUGIN_PATH=str(broken))
    assert done.returncode != 0
