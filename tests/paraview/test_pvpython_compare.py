"""The macro that compares all skeletons, in a real ParaView."""

from __future__ import annotations

import json

from paths import PLUGIN
from tetraskel.options import COMPARED

MACRO = PLUGIN.parent / "macros" / "compare_skeletons.py"
RUN = f"""
LoadPlugin(PLUGIN, remote=False, ns=globals())
cloud = XMLPolyDataReader(registrationName="cloud", FileName=ROOT + "/sample_data/torus.vtp")
SetActiveSource(cloud)
exec(compile(open({str(MACRO)!r}).read(), {str(MACRO)!r}, "exec"))
import json
names = {{name: proxy.GetDataInformation().GetNumberOfPoints() for (name, _), proxy in GetSources().items()}}
json.dump({{"points": names, "views": len(GetRenderViews())}}, open("out.json", "w"))
"""


def test_every_method_is_an_entry_with_a_view(pvpython, tmp_path):
    done = pvpython(RUN, screen=True)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "out.json").read_text())
    assert found["views"] == len(COMPARED)
    drawn = {name for name in COMPARED if found["points"][name] > 0}
    assert drawn >= set(COMPARED) - {"thinning"}  # which needs a package that ParaView may not have
    told = [line for line in done.stderr.splitlines() if line.strip()]
    assert all("scikit-image" in line for line in told), done.stderr


def test_without_a_source_or_the_plugin_it_says_so(pvpython):
    macro = f"exec(compile(open({str(MACRO)!r}).read(), 'macro', 'exec'))"
    assert "expected a source chosen in the pipeline browser" in pvpython(macro).stderr
    assert "expected the tetraskel plugin, which is not loaded" in pvpython(f"Sphere()\n{macro}").stderr
