"""Write the saved state `sample_data/skeleton_in_object.pvsm`: `pvpython tools/make_state.py`, with a screen.

The state names the sample without its folder, so that ParaView asks where the file is, or finds it beside the state.
"""

from pathlib import Path

from paraview.simple import GetActiveViewOrCreate, LoadPlugin, SaveState, SetActiveSource, XMLPolyDataReader

ROOT = Path(__file__).resolve().parents[1]
STATE = ROOT / "sample_data" / "skeleton_in_object.pvsm"
MACRO = ROOT / "plugin" / "macros" / "skeleton_in_object.py"

LoadPlugin(str(ROOT / "plugin" / "tetraskel_plugin.py"), remote=False, ns=globals())
view = GetActiveViewOrCreate("RenderView")
view.CameraPosition, view.CameraViewUp = [1, -2, 0.8], [0, 0, 1]
SetActiveSource(XMLPolyDataReader(registrationName="y_tube.vtp", FileName=str(ROOT / "sample_data" / "y_tube.vtp")))
exec(compile(MACRO.read_text(), str(MACRO), "exec"))
SaveState(str(STATE))
STATE.write_text(STATE.read_text().replace(f"{ROOT}/sample_data/", ""))
