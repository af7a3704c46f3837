"""The plugin in a ParaView window, driven by its own widgets on a virtual screen."""

from __future__ import annotations

import numpy as np
import pytest

from gui import APPLY, PANEL, PROPERTIES, WINDOW, chain, check, choose_filter, event, menu
from paths import PLUGIN

pyvista = pytest.importorskip("pyvista")

OPEN = """
cloud = XMLPolyDataReader(registrationName="cloud", FileName={!r})
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
SetActiveSource(cloud)
"""


PLUGINS = f"{WINDOW}/PluginManagerDialog"
DETAIL = f"{PROPERTIES}/Detail/DoubleRangeWidget"


def load(file):
    """Load a plugin by the dialog for it."""
    return [
        menu("menuTools", "actionManage_Plugins"),
        event(f"{PLUGINS}/splitter/localGroup/loadLocal", "activate"),
        event(f"{PLUGINS}/pqFileDialog", "filesSelected", str(file)),
        event(f"{PLUGINS}/buttonBox/1QPushButton0", "activate"),
    ]


def test_from_the_plugin_manager_to_a_state_that_reopens(paraview, small, tmp_path):
    """Load, one click, a slider, Apply, what was found, undo, save; another ParaView opens what was saved."""
    events = [
        *load(PLUGIN),
        choose_filter("CurveSkeleton"),
        check(f"{DETAIL}/DoubleLineEdit", "0.5"),
        APPLY,
        check(f"{PROPERTIES}/FoundLoops/FoundLoops", "1"),
        event(f"{DETAIL}/Slider", "set_int", "90"),
        APPLY,
        check(f"{DETAIL}/DoubleLineEdit", "0.9"),
        event(f"{DETAIL}/DoubleLineEdit", "set_string", "0.2"),
        APPLY,
        menu("menu_Edit", "actionEditUndo"),
        check(f"{DETAIL}/DoubleLineEdit", "0.9"),
        menu("menu_File", "actionFileSaveServerState"),
        event(f"{WINDOW}/FileSaveServerStateDialog", "filesSelected", str(tmp_path / "saved.pvsm")),
    ]
    done = paraview("\n".join(events), script=OPEN.format(str(small)))
    assert done.returncode == 0, done.stdout + done.stderr
    reopen = f'LoadState({str(tmp_path / "saved.pvsm")!r})\nSetActiveSource(FindSource("CurveSkeleton1"))'
    events = [check(f"{DETAIL}/DoubleLineEdit", "0.9"), check(f"{PANEL}/Accept", "false", "enabled")]
    done = paraview("\n".join(events), script=reopen, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.returncode == 0, done.stdout + done.stderr


HIDDEN = "\n".join(
    [
        choose_filter("CurveSkeleton"),
        check(f"{PROPERTIES}/RootPoint", "false", "visible"),
        event(f"{PROPERTIES}/Root/ComboBox", "activated", "Point"),
        check(f"{PROPERTIES}/RootPoint", "true", "visible"),
        check(f"{PROPERTIES}/SheetAngle", "false", "visible"),
        event(f"{PANEL}/Delete", "activate"),
        choose_filter("RasterSkeleton"),
        check(f"{PROPERTIES}/MaskArray", "false", "visible"),
        check(f"{PROPERTIES}/Resolution", "true", "visible"),
        event(f"{PANEL}/Delete", "activate"),
        choose_filter("SkeletonSurface"),
        check(f"{PROPERTIES}/MaxCells", "true", "visible"),
        event(f"{PROPERTIES}/Spacing/DoubleLineEdit0", "set_string", "0.1"),
        check(f"{PROPERTIES}/MaxCells", "false", "visible"),
        event(f"{PANEL}/Delete", "activate"),
    ]
)
THRESHOLD = f"{PROPERTIES}/Threshold/DoubleRangeWidget/DoubleLineEdit"
APPLIED = "\n".join(
    [
        chain("DelaunayMesh", "TreeBuilder"),
        choose_filter("FlatTetraRemoval"),
        check(THRESHOLD, "0.01"),
        event(THRESHOLD, "set_string", "0.2"),
        APPLY,
        check(THRESHOLD, "0.2"),
        chain("SkeletonOutput"),
        check(f"{PANEL}/Accept", "false", "enabled"),
    ]
)


def test_the_skeleton_is_drawn_options_are_hidden_and_the_menu_s_chain_is_applied(paraview, small, tmp_path):
    """In one window: its start takes longer than all of this."""
    done = paraview(HIDDEN + "\n" + APPLIED, script=OPEN.format(str(small)) + DRAW, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.returncode == 0, done.stdout + done.stderr
    picture = pyvista.read(tmp_path / "drawn.png").point_data.active_scalars
    assert len(np.unique(np.asarray(picture), axis=0)) > 50


def test_a_broken_plugin_is_noticed(paraview, small, tmp_path):
    """The test above can fail: with a plugin that does not load its menu is not there, and all before it is.

    The same events get beyond this step with the whole plugin.
    """
    broken = tmp_path / "plugins"
    broken.mkdir()
    (broken / PLUGIN.name).write_text("raise ImportError('broken on purpose')\n")
    missing = 'couldn\'t find action  "Skeleton Tree"'
    script = OPEN.format(str(small)) + "print('the cloud is open', flush=True)\n"
    for folder, fails in ((broken, True), (PLUGIN.parent, False)):
        done = paraview(chain("DelaunayMesh"), script=script, PV_PLUGIN_PATH=str(folder))
        told = done.stdout + done.stderr
        assert "the cloud is open" in told
        assert (done.returncode != 0, "broken on purpose" in told, missing in told) == (fails, fails, fails), told
