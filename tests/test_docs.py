"""The documentation is right: every block of code runs, and every parameter and name is there."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, fields
from pathlib import Path

import pytest
import pyvista

import tetraskel
from paths import ENVIRONMENT, PLUGIN, ROOT, SAMPLES
from programs import finished, program
from tetraskel import options, vtkfilters
from tetraskel.cli import main

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "sample_data" / "README.md", *sorted(DOCS.rglob("*.md"))]
FILTERS = [name for name in vtkfilters.__all__ if name != "SkeletonFilter"]
BLOCK = re.compile(r"(?:<!-- not run: (?P<reason>[^>]+) -->\n)?^```(?P<kind>\w*)\n(?P<code>.*?)^```$", re.M | re.S)
RUN = ("python", "sh")


@dataclass(frozen=True)
class Block:
    """A block of code of a page: its language, its text, and why it is not run, if it is not."""

    kind: str
    code: str
    reason: str | None

    @property
    def is_for_paraview(self):
        return "from paraview" in self.code


def blocks_of(page):
    text = page.read_text(encoding="utf-8")
    return [Block(found["kind"], found["code"], found["reason"]) for found in BLOCK.finditer(text)]


def titled(page):
    return str(page.relative_to(ROOT))


def pages_with(wanted):
    return [page for page in PAGES if any(wanted(block) for block in blocks_of(page) if not block.reason)]


def test_every_block_is_run_or_says_why_not():
    found = [block for page in PAGES for block in blocks_of(page)]
    assert len(found) > 30
    for page in PAGES:
        assert page.read_text(encoding="utf-8").count("\n```") == 2 * len(blocks_of(page)), page
        for block in blocks_of(page):
            assert block.kind in RUN or block.reason, (titled(page), block.code)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder with the sample data, the plugin and the command in their places."""
    (tmp_path / "sample_data").symlink_to(SAMPLES)
    (tmp_path / "plugin").symlink_to(PLUGIN.parent)
    commands = tmp_path / ".venv" / "bin"
    commands.mkdir(parents=True)
    script = commands / "tetraskel"
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m tetraskel "$@"\n')
    script.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", pages_with(lambda block: block.kind == "python"), ids=titled)
def test_python_runs(page, folder):
    """All blocks of a page, one behind the other, as a reader types them."""
    names = {"__name__": "__main__"}
    for block in blocks_of(page):
        if block.kind == "python" and not block.is_for_paraview and not block.reason:
            if ">>" in block.code and not hasattr(vtkfilters.DelaunayMesh, "__rshift__"):
                continue  # VTK 9.4 and later
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block.code, titled(page), "exec"), names)


@pytest.mark.parametrize("page", pages_with(lambda block: block.kind == "sh"), ids=titled)
def test_shell_runs(page, folder, capsys):
    """All commands of a page: plain ones of tetraskel in this process, which saves its start, all others by bash."""
    lines = [line for block in blocks_of(page) if block.kind == "sh" and not block.reason for line in lines_of(block)]
    path = f"{folder / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    for line in lines:
        words = shlex.split(line, comments=True)
        if Path(words[0]).name == "tetraskel" and not set("|<>$&*;") & set(line):
            assert status_of(words[1:]) == 0, (line, capsys.readouterr().err)
        else:
            command = ["bash", "-e", "-o", "pipefail", "-c", line]
            done = subprocess.run(command, capture_output=True, text=True, env={**ENVIRONMENT, "PATH": path})
            assert (done.returncode, done.stderr) == (0, ""), line
    assert "warning" not in capsys.readouterr().err


def lines_of(block):
    """The commands of a block, a line each."""
    return [line for line in block.code.replace("\\\n", " ").splitlines() if line.strip() and line[0] != "#"]


def status_of(words):
    """The status of a command; help leaves by an exception."""
    try:
        return main(words)
    except SystemExit as leave:
        return leave.code


@pytest.mark.parametrize("page", pages_with(lambda block: block.is_for_paraview), ids=titled)
def test_scripts_for_paraview_run(page, folder):
    executable = program("pvpython")
    code = "\n".join(block.code for block in blocks_of(page) if block.is_for_paraview and not block.reason)
    (folder / "script.py").write_text(code)
    done = finished([executable, "script.py"], folder, {})
    assert (done.returncode, done.stderr) == (0, "")


def hook():
    """What makes the tables of parameters when the site is built."""
    spec = importlib.util.spec_from_file_location("options_tables", DOCS / "options_tables.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def page_of(name):
    words = re.findall("[A-Z][a-z]+", name)
    return DOCS / "filters" / ("_".join(words).lower() + ".md")


@pytest.mark.parametrize("name", FILTERS)
def test_a_filters_page_has_a_picture_code_and_all_parameters(name):
    text = page_of(name).read_text(encoding="utf-8")
    assert "](../pictures/" in text
    assert "```python" in text
    assert "```sh" in text
    table = hook().on_page_markdown(text)
    assert "<!-- options" not in table
    for declared in fields(getattr(vtkfilters, name).options):
        rows = [line for line in table.splitlines() if line.startswith(f"| `{declared.name}`")]
        assert len(rows) == 1
        assert f"`{declared.default!r}`" in rows[0]
        assert declared.metadata["doc"].replace("|", "&#124;") in rows[0]
        assert all(f"`{word}`" in rows[0] for word in declared.metadata["choices"])
        assert declared.metadata["unit"] in rows[0]


def test_tables_are_made_of_option_sets_too():
    assert hook().table_of("FlatOptions") == hook().table_of("FlatTetraRemoval")
    assert hook().table_of("Options") == "None."
    assert "| 0 to 1" in hook().table_of("CompareOptions")
    assert "from 0 [length of the input]" in hook().table_of("SurfaceOptions")
    assert options.SurfaceOptions().spacing == 0


def test_the_reference_has_every_public_name():
    named = set(re.findall(r"^::: tetraskel\.(\w+)$", (DOCS / "api.md").read_text(encoding="utf-8"), re.M))
    assert named == set(tetraskel.__all__)


def anchors_of(page):
    """What a page's headings can be reached by."""
    heads = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", head).strip().lower().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=titled)
def test_links_and_pictures_are_there(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+:", link):
            continue
        target, _, anchor = link.partition("#")
        there = (page.parent / target).resolve() if target else page
        assert there.exists(), link
        assert not anchor or anchor in anchors_of(there), link


def test_pictures_are_small_and_all_are_used():
    used = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for drawn in (DOCS / "pictures").iterdir():
        assert drawn.name in used, drawn
        assert drawn.stat().st_size < 200_000, drawn
        assert pyvista.read(drawn).dimensions[0] <= 2100


def test_every_page_is_in_the_menu():
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"[\w/]+\.md", text[text.index("\nnav:") :])
    assert sorted(listed) == sorted(str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md"))


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the site, built once."""
    for package in ("mkdocs", "mkdocstrings", "material"):
        pytest.importorskip(package)
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**ENVIRONMENT, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_site_has_options_and_names(site):
    page = (site / "filters" / "curve_skeleton.html").read_text(encoding="utf-8")
    assert options.CurveOptions.__dataclass_fields__["loop_spacings"].metadata["doc"] in page
    reference = (site / "api.html").read_text(encoding="utf-8")
    assert all(f'id="tetraskel.{name}"' in reference for name in tetraskel.__all__)


def test_the_site_fetches_nothing_from_elsewhere(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) > len(list(DOCS.rglob("*.md")))
    for page in pages:
        text = page.read_text(encoding="utf-8")
        fetched = re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=[\"']?((?:https?:)?//[^\"'\s>]*)", text)
        assert not fetched, page
        assert "unpkg" not in text, page
    assert not [path for path in site.rglob("*") if path.suffix == ".py" or path.name == "__pycache__"]


def test_search_works_without_a_server(site, tmp_path):
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        pytest.skip("chromium is not installed")
    for page in ("index.html", "filters/curve_skeleton.html"):
        command = [browser, "--headless=new", "--no-sandbox", f"--user-data-dir={tmp_path / 'browser'}",
                   "--virtual-time-budget=5000", "--dump-dom", f"{(site / page).as_uri()}?q=Strahler"]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert "md-search-result__item" in done.stdout
