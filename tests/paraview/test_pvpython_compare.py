"""The macro that compares all skeletons, in a real ParaView."""

from __future__ import annotations

import json
import shutil

import pytest

from paths import PLUGIN
from tetraskel.options import COMPARED

MACRO = PLUGIN.parent / "macros" / "compare_skeletons.py"
RUN = f"exec(compile(open({str(MACRO)!r}).read(), {str(MACRO)!r}, 'exec'))"
FAIL = f"""
try:
    {RUN}
except RuntimeError as error:
    print(error)
"""
SCRIPTS = {
    "no_source": FAIL,
    "no_plugin": f"Sphere()\n{FAIL}",
    "compared": f"""
ResetSession()
LoadPlugin(PLUGIN, remote=False, ns=globals())
cloud = XMLPolyDataReader(registrationName="cloud", FileName="torus.vtp")
SetActiveSource(cloud)
{RUN}
import json
names = {{name: proxy.GetDataInformation().GetNumberOfPoints() for (name, _), proxy in GetSources().items()}}
print(json.dumps({{"points": names, "views": len(GetRenderViews())}}))
""",
}


@pytest.fixture(scope="module")
def parts(in_one_pvpython, small):
    """Without a source, without the plugin, and with both."""
    return in_one_pvpython(SCRIPTS, lambda folder: shutil.copy(small, folder), screen=True)


def test_every_method_is_an_entry_with_a_view(parts):
    found = json.loads(parts["compared"].printed)
    assert found["views"] == len(COMPARED)
    drawn = {name for name in COMPARED if found["points"][name] > 0}
    assert drawn >= set(COMPARED) - {"thinning"}  # which needs a package that ParaView may not have
    told = [line for line in parts["compared"].said.splitlines() if line.strip()]
    assert all("scikit-image" in line or "as the points are few" in line for line in told), told


def test_without_a_source_or_the_plugin_it_says_so(parts):
    assert "expected a source chosen in the pipeline browser" in parts["no_source"].printed
    assert "expected the tetraskel plugin, which is not loaded" in parts["no_plugin"].printed
