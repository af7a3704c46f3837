"""No output is written over an input, whichever options name the two."""

from __future__ import annotations

import os

import pytest

from commands import run
from tetraskel.cli.completion import commands
from tetraskel.cli.outputs import InputFile, OutputFile, Written

FILES = ("IN", "OUT", "OUTFOLDER", "SKELETON", "SURFACE", "FILE")  # metavars of what names a file
SUFFIX = {"png": ".png", "html": ".html", "edges": ".csv", "table": ".csv", "pieces": ".vtu"}


def of_kind(command, kind):
    return [action for action in command._actions if action.type is kind]


PAIRS = [
    (name, source.dest, target.dest)
    for name, command in commands().items()
    for source in of_kind(command, InputFile)
    for target in of_kind(command, OutputFile)
]
TWICE = [
    (name, first.dest, second.dest)
    for name, command in commands().items()
    for k, first in enumerate(of_kind(command, OutputFile))
    for second in of_kind(command, OutputFile)[:k]
    if first.metavar != "OUTFOLDER"
]


def words_for(command, files):
    """A call in which these destinations have these files, and the other places files of their own."""
    words = []
    for action in command._actions:
        if action.option_strings and action.dest in files:
            words += [action.option_strings[0], files[action.dest]]
        elif not action.option_strings:
            words.append(files.get(action.dest, f"other_{action.dest}.vtp"))
    return words


@pytest.mark.parametrize("name", commands())
def test_every_argument_that_names_a_file_says_whether_it_is_read_or_written(name):
    for action in commands()[name]._actions:
        assert (action.metavar in FILES) == (action.type in (InputFile, OutputFile)), action.dest


def test_the_pairs_are_those_that_matter():
    for pair in [("tree", "boundary", "output"), ("surface", "against", "output"), ("surface", "sheets", "png")]:
        assert pair in PAIRS
    assert ("skeleton", "output", "points") in TWICE or ("skeleton", "points", "output") in TWICE


@pytest.mark.parametrize(("name", "source", "target"), PAIRS)
@pytest.mark.parametrize("how", ["itself", "link"])
def test_no_output_is_written_over_an_input(tmp_path, capsys, monkeypatch, name, source, target, how):
    monkeypatch.chdir(tmp_path)
    file = "precious" + SUFFIX.get(target, ".vtp")
    if name == "compare":  # writes into a folder
        (tmp_path / "out").mkdir()
        file = "out/curve.vtp"
    (tmp_path / file).write_text("precious")
    read = file
    if how == "link":
        os.link(file, "another.vtp")
        read = "another.vtp"
    written = "out" if name == "compare" else file
    status, out, err = run(capsys, name, *words_for(commands()[name], {source: read, target: written}))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"expected an output beside the input, got '{file}' for both" in err
    assert (tmp_path / file).read_text() == "precious"


@pytest.mark.parametrize(("name", "first", "second"), TWICE)
def test_no_two_outputs_are_one_file(tmp_path, capsys, monkeypatch, name, first, second):
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, name, *words_for(commands()[name], {first: "o.vtp", second: "o.vtp"}))
    assert status == 2
    assert "expected a file for each output, got 'o.vtp' for two" in err


def test_one_of_several_inputs_is_not_written_over_by_the_result_of_another(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("one.csv", "precious.csv"):
        (tmp_path / name).write_text("0,0,0\n1,0,0\n0,1,0\n0,0,1\n")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "one.vtp").symlink_to(tmp_path / "precious.csv")
    status, _, err = run(capsys, "tree", "one.csv", "precious.csv", "out")
    assert status == 2
    assert "expected an output beside the input" in err
    assert (tmp_path / "precious.csv").read_text().startswith("0,0,0")


@pytest.fixture
def points(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.csv").write_text("0,0,0\n1,0,0\n0,1,0\n0,0,1\n1,1,1\n")
    (tmp_path / "two.csv").write_text("0,0,0\n2,0,0\n0,1,0\n0,0,1\n1,1,1\n")
    return tmp_path


def interrupt(*_):
    raise KeyboardInterrupt


@pytest.mark.parametrize("before", [False, True])
def test_who_stops_the_drawing_hears_that_the_result_was_written(points, capsys, monkeypatch, before):
    if before:
        (points / "o.vtp").write_text("an old one")
    monkeypatch.setattr("tetraskel.cli.picture.draw", interrupt)
    status, _, err = run(capsys, "tree", "one.csv", "o.vtp", "--png", "o.png")
    assert (status, err) == (130, "tetraskel tree: stopped; o.vtp was written before.\n")
    assert (points / "o.vtp").read_text().startswith("<?xml")


def test_who_stops_the_work_hears_that_an_old_file_is_as_it_was(points, capsys, monkeypatch):
    (points / "o.vtp").write_text("an old one")
    monkeypatch.setattr("tetraskel.cli.chain.read_points", interrupt)
    assert run(capsys, "tree", "one.csv", "o.vtp")[::2] == (130, "tetraskel tree: stopped; nothing was written.\n")


def test_results_of_inputs_before_are_told_too(points, capsys, monkeypatch):
    from tetraskel.cli import chain

    reading = chain.read_points
    monkeypatch.setattr(chain, "read_points", lambda path: interrupt() if path == "two.csv" else reading(path))
    (points / "out").mkdir()
    status, _, err = run(capsys, "tree", "one.csv", "two.csv", "out")
    assert (status, err) == (130, "tetraskel tree: stopped; out/one.vtp was written before.\n")


def test_files_of_a_folder_that_were_written_are_told(points):
    from argparse import Namespace

    (points / "out").mkdir()
    written = Written([Namespace(output=OutputFile("out"))])
    assert written.told() == "nothing was written"
    (points / "out" / "table.md").write_text("a table")
    assert written.told() == "out was written before"


def test_many_files_are_counted(points):
    from argparse import Namespace

    names = [f"{k}.vtp" for k in range(5)]
    written = Written([Namespace(output=OutputFile(name)) for name in names])
    for name in names:
        (points / name).write_text("new")
    assert written.told() == "0.vtp, 1.vtp, 2.vtp and 2 more were written before"
