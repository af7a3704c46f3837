"""The help teaches: its examples run as they stand, and it says the defaults there are."""

from __future__ import annotations

import glob
import io
import os
import pty
import shlex
import shutil
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
import pyvista

from paths import ENVIRONMENT, SAMPLES
from tetraskel.cli import COMMANDS, main, parser
from tetraskel.cli.usage import HelpForm, Parser


def help_of(capsys, *words):
    with pytest.raises(SystemExit) as leave:
        main([*words, "--help"])
    assert leave.value.code == 0
    return capsys.readouterr().out


def test_the_first_page_names_every_command(capsys):
    text = help_of(capsys)
    for name in COMMANDS:
        assert f"\n    {name}" in text


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_examples(capsys, name):
    text = help_of(capsys, name)
    assert COMMANDS[name].EXAMPLES
    for meaning, command in COMMANDS[name].EXAMPLES:
        assert f"\n  {meaning}\n    tetraskel {command}\n" in text
        assert command.split()[0] == name
    assert "(default: None)" not in text
    assert text.startswith(f"usage: tetraskel {name} ")


def test_defaults_are_told_where_there_are_some():
    made = Parser(prog="it", formatter_class=HelpForm)
    made.add_argument("--share", default=0.5, help="a share")
    made.add_argument("--file", help="a file")
    made.add_argument("--quiet", action="store_true", help="no words")
    text = made.format_help()
    assert "a share (default: 0.5)" in text
    assert "a file\n" in text
    assert "no words\n" in text


def folder_of_a_user(place):
    """What the examples speak of."""
    points = pyvista.read(SAMPLES / "bent_tube.vtp").points[::4]
    scan = pyvista.PolyData(points)
    (place / "scans").mkdir()
    (place / "skeletons").mkdir()
    for name in ("scan.ply", "scans/one.ply", "scans/two.ply"):
        scan.save(place / name)
    shutil.copy(SAMPLES / "cloud20.csv", place / "cloud.csv")
    np.save(place / "big.npy", points[::4])
    np.save(place / "scan.npy", points)
    mask = pyvista.ImageData(dimensions=(12, 12, 12))
    mask["mask"] = (abs(mask.points - 5.5).max(axis=1) < 4).astype("uint8")
    mask.save(place / "mask.vti")


def words_of(command):
    """The words of a command as a shell hands them over, and the file on its standard input."""
    words = shlex.split(command, comments=True)
    words = [found for word in words for found in (sorted(glob.glob(word)) if "*" in word else [word])]
    return (words[:-2], words[-1]) if "<" in words else (words, None)


def test_the_examples_run(tmp_path, capsys, monkeypatch):
    pytest.importorskip("skimage")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pyvista, "OFF_SCREEN", True)
    folder_of_a_user(tmp_path)
    examples = [command for module in COMMANDS.values() for _, command in module.EXAMPLES]
    first = "surface skeleton.vtp surface.ply"  # what the example of measure is about
    for command in [*examples[:1], first, *examples[1:]]:
        words, file = words_of(command)
        content = Path(file).read_bytes() if file else b""
        monkeypatch.setattr("sys.stdin", types.SimpleNamespace(buffer=io.BytesIO(content)))
        assert main(words) == 0, (command, capsys.readouterr().err)
    made = {path.name for path in tmp_path.rglob("*.*")}
    assert {"skeleton.html", "branches.csv", "one.vtp", "two.vtp", "object.stl", "curves.vtu", "overview.png"} <= made


def on_a_terminal(command, folder):
    """What a program writes to a terminal that is its standard error."""
    terminal, end = pty.openpty()
    done = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=end, env=ENVIRONMENT, cwd=folder)
    os.close(end)
    written = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:  # Linux: the other end has been closed
            break
        if not part:
            break
        written += part
    os.close(terminal)
    assert done.wait() == 0
    return written.decode()


def test_progress_is_drawn_on_a_terminal_and_not_in_a_pipe(tmp_path):
    command = [sys.executable, "-m", "tetraskel", "skeleton", str(SAMPLES / "bent_tube.vtp"), "out.vtp"]
    drawn = on_a_terminal(command, tmp_path)
    assert "\r#" in drawn
    assert "%" in drawn
    assert drawn.endswith("\r")
    assert not drawn.split("\r")[-2].strip()  # the line is wiped at the end
    piped = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, cwd=tmp_path)
    assert (piped.returncode, piped.stderr) == (0, "")
    assert "\r" not in piped.stdout


@pytest.mark.parametrize("name", ["skeleton", "surface", "compare"])
def test_the_help_says_how_many_lines_of_json_come(capsys, name):
    told = " ".join(help_of(capsys, name).split())
    assert ("as a line of JSON, one for each input" in told) == (name != "compare")


def test_the_parser_is_made_anew_each_time():
    assert parser().format_help() == parser().format_help()
