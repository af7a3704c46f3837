"""Windows and pages: what they hold is the result, and a page needs nothing but a browser."""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
import pyvista

from commands import run
from paths import ENVIRONMENT, SAMPLES
from programs import virtual_screen
from tetraskel.cli import main, page, picture
from tetraskel.vtkfilters.convert import segments_of

CLOUD = SAMPLES / "cloud20.csv"
RADIUS = "MaximumInscribedSphereRadius"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A skeleton, its points and its page."""
    folder = tmp_path_factory.mktemp("page")
    scan = pyvista.PolyData(pyvista.read(SAMPLES / "torus.vtp").points[::2])
    scan.save(folder / "scan.vtp")
    files = [str(folder / name) for name in ("scan.vtp", "skeleton.vtp", "page.html")]
    assert main(["skeleton", *files[:2], "--html", files[2]]) == 0
    return folder


def geometry_of(file):
    text = file.read_text(encoding="utf-8")
    (found,) = re.findall(r'<script type="application/json" id="geometry">(.*?)</script>', text, re.DOTALL)
    return json.loads(found)


def test_the_page_holds_the_skeleton(made):
    skeleton, shown = pyvista.read(made / "skeleton.vtp"), geometry_of(made / "page.html")
    assert np.array_equal(shown["points"], skeleton.points)
    assert np.array_equal(shown["radius"], skeleton[RADIUS])
    assert np.array_equal(shown["edges"], segments_of(skeleton.GetLines(), closed=False))
    assert shown["triangles"] == []
    assert np.array_equal(shown["colours"]["depth"], skeleton.point_data["Depth"])
    assert np.array_equal(shown["colours"]["branch"], skeleton.point_data["BranchId"])


def test_the_page_holds_the_points_of_the_object(made):
    scan, cloud = pyvista.read(made / "scan.vtp"), geometry_of(made / "page.html")["cloud"]
    places = np.reshape(cloud["places"], (-1, 3)) * cloud["step"] + cloud["origin"]
    assert cloud["total"] == len(places) == scan.n_points
    assert np.abs(places - scan.points).max() <= 0.51 * cloud["step"] < 1e-5 * scan.length


def test_the_page_asks_for_nothing(made):
    text = (made / "page.html").read_text(encoding="utf-8")
    for asks in ("http:", "https:", "src=", "href=", "url(", "import ", "fetch(", "@import", "XMLHttp", "//cdn"):
        assert asks not in text
    assert "{{" not in text


def test_a_surface_and_what_has_no_radius(made, tmp_path, capsys):
    assert run(capsys, "surface", made / "skeleton.vtp", tmp_path / "s.ply", "--html", tmp_path / "s.html")[0] == 0
    shown = geometry_of(tmp_path / "s.html")
    assert np.array_equal(shown["triangles"], pyvista.read(tmp_path / "s.ply").regular_faces)
    assert shown["smooth"]
    assert run(capsys, "tree", CLOUD, tmp_path / "t.vtp", "--html", tmp_path / "t.html")[0] == 0
    shown = geometry_of(tmp_path / "t.html")
    assert shown["radius"] is None
    assert list(shown["colours"]) == ["depth"]


def test_no_name_can_break_the_page(tmp_path):
    cloud, title = pyvista.PolyData(np.eye(3)), "</script><b>&{{geometry}}.vtp"
    page.write_page(cloud, pyvista.PolyData(), tmp_path / "p.html", title)
    assert geometry_of(tmp_path / "p.html")["title"] == title
    text = (tmp_path / "p.html").read_text(encoding="utf-8")
    assert f"<title>{html.escape(title)}</title>" in text
    assert text.count("</script>") == 2


def test_values_that_are_not_finite_are_none():
    line = pyvista.Line((0, 0, 0), (1, 0, 0), resolution=2)
    line[RADIUS] = np.array([np.nan, 1.0, np.inf])
    assert page.geometry(line, pyvista.PolyData(), "line")["radius"] == [None, 1.0, None]


def test_many_points_of_the_object_are_thinned_and_counted(monkeypatch):
    monkeypatch.setattr(page, "CLOUD_POINTS", 10)
    cloud = page.geometry(pyvista.PolyData(), pyvista.PolyData(np.random.default_rng(0).random((35, 3))), "")["cloud"]
    assert (len(cloud["places"]), cloud["total"]) == (30, 35)


def test_too_large_a_result_is_refused(made, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(page, "LARGEST", 10)
    status, _, err = run(capsys, "view", made / "skeleton.vtp", "--html", tmp_path / "p.html")
    assert status == 2
    assert "expected at most 10 points for a page, got" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.vtp"], "which does not exist"),
        (["t.txt", "--html", "p.png"], "expected an output file ending in .html .htm, got 'p.png'"),
        (["t.txt", "--png", "t.png", "--html", "no/p.html"], "expected a folder to write into"),
        (["t.txt"], "expected a display for the window, got none; use --html FILE or --png FILE."),
        (["t.html", "--html", "t.html"], "expected an output beside the input"),
    ],
)
def test_what_cannot_be_viewed(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pyvista, "OFF_SCREEN", False)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "t.txt").write_text("0 0 0\n1 0 0\n0 1 0\n")
    (tmp_path / "t.html").write_text("old")
    if "expected a display" in message and not sys.platform.startswith("linux"):
        pytest.skip("other systems have a display")
    status, out, err = run(capsys, "view", *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


@pytest.mark.parametrize("kind", ["skeleton.vtp", "lines.swc", "mesh.vtu", "scan.vtp"])
def test_a_window_is_filled(made, tmp_path, capsys, monkeypatch, kind):
    shown = []
    monkeypatch.setattr(pyvista, "OFF_SCREEN", True)
    monkeypatch.setattr(picture, "SIZE", (300, 200))
    monkeypatch.setattr(pyvista.Plotter, "show", lambda plotter: shown.append(np.array(plotter.screenshot())))
    pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid().save(made / "mesh.vtu")
    (made / "lines.swc").write_text("1 0 0 0 0 0.5 -1\n2 0 1 0 0 0.2 1\n")
    assert run(capsys, "view", made / kind, "--points", made / "scan.vtp") == (0, "", "")
    assert len(np.unique(shown[0].reshape(-1, 3), axis=0)) > 20
    status, out, _ = run(capsys, "view", made / kind, "--png", tmp_path / "p.png")
    assert status == 0
    assert out.startswith(f"{made / kind}: ")
    assert out.endswith("p.png\n")
    assert len(np.unique(pyvista.read(tmp_path / "p.png").active_scalars, axis=0)) > 3


def test_a_window_opens_on_a_display(made):
    if shutil.which("xvfb-run") is None:
        pytest.skip("xvfb-run is not installed")
    code = (
        "import pyvista, sys\n"
        "from tetraskel.cli import main\n"
        "opened = []\n"
        "def look(plotter):\n"  # the window may be mapped after the first of these
        "    def end(step):\n"
        "        opened.append(plotter.render_window.GetMapped())\n"
        "        if opened[-1] or step > 300:\n"
        "            plotter.iren.terminate_app()\n"
        "    plotter.iren.add_timer_event(1000, 200, end)\n"
        "real = pyvista.Plotter.show\n"
        "pyvista.Plotter.show = lambda plotter: (look(plotter), real(plotter))[1]\n"
        "status = main(['view', 'skeleton.vtp', '--points', 'scan.vtp'])\n"
        "print(status, opened[-1])\n"
    )
    environment = {key: value for key, value in ENVIRONMENT.items() if key != "PYVISTA_OFF_SCREEN"}
    command = ["xvfb-run", *virtual_screen(), sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, cwd=made, env=environment, timeout=300)
    assert (done.returncode, done.stdout) == (0, "0 1\n"), done.stderr


PROBE = """<script>{
const look = () => { draw(); const n = 4 * gl.drawingBufferWidth * gl.drawingBufferHeight, seen = new Uint8Array(n);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, seen); return seen; };
const apart = (a, b) => { let n = 0; for (let k = 0; k < a.length; k++) n += a[k] !== b[k]; return n; };
const send = (kind, x, y, id) => canvas.dispatchEvent(
  new PointerEvent(kind, { clientX: x, clientY: y, pointerId: id, buttons: 1 }));
const found = { error: gl.getError() }, first = look();
found.drawn = first.filter(value => value < 250).length;
send("pointerdown", 300, 300, 1); send("pointermove", 380, 330, 1); send("pointerup", 380, 330, 1);
found.turned = apart(first, look());
canvas.dispatchEvent(new MouseEvent("dblclick"));
found.back = apart(first, look());
const before = view.zoom;
send("pointerdown", 300, 300, 1); send("pointerdown", 400, 300, 2); send("pointermove", 500, 300, 2);
found.pinched = view.zoom / before;
document.documentElement.dataset.found = JSON.stringify(found);
}</script></body>"""


def test_a_browser_draws_and_turns_it(made):
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        pytest.skip("chromium is not installed")
    probed = made / "probed.html"
    probed.write_text((made / "page.html").read_text(encoding="utf-8").replace("</body>", PROBE), encoding="utf-8")
    switches = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    folder = f"--user-data-dir={made / 'browser'}"
    command = [browser, *switches, folder, "--virtual-time-budget=3000", "--dump-dom", probed.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, env=dict(os.environ))
    (found,) = re.findall(r'data-found="([^"]*)"', done.stdout)
    found = json.loads(html.unescape(found))
    assert found["error"] == found["back"] == 0
    assert found["drawn"] > 10_000
    assert found["turned"] > 10_000
    assert found["pinched"] == pytest.approx(2.0)
