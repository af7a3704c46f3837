"""The scripts of `tetraskel completion`, in the shells themselves."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import subprocess
import time

import pytest

from tetraskel.cli import COMMANDS, main
from tetraskel.cli.completion import SHELLS, commands, options
from tetraskel.options import CENTRES


def script_of(shell, capsys):
    assert main(["completion", shell]) == 0
    return capsys.readouterr().out


@pytest.fixture
def script(tmp_path, capsys):
    """The script for a shell in a file, or a skipped test where the shell is not installed."""

    def make(shell):
        if shutil.which(shell) is None:
            pytest.skip(f"{shell} is not installed")
        (tmp_path / "script").write_text(script_of(shell, capsys))
        return tmp_path / "script"

    return make


@pytest.mark.parametrize("shell", SHELLS)
def test_every_command_and_option_is_in_it(shell, capsys):
    text = script_of(shell, capsys)
    for name, command in commands().items():
        assert name in text
        for action in options(command):
            for flag in action.option_strings:
                in_fish = f" -l {flag[2:]}" if flag.startswith("--") else f" -s {flag[1:]}"
                assert (in_fish if shell == "fish" else flag) in text


def in_bash(file, *words):
    """What bash offers behind these words, the last of them begun."""
    line = " ".join(f"'{word}'" for word in words)
    lines = [f"source {file}", f"COMP_WORDS=({line})", f"COMP_CWORD={len(words) - 1}", "_tetraskel"]
    command = "; ".join([*lines, 'echo "${COMPREPLY[@]}"'])
    done = subprocess.run(["bash", "--norc", "-c", command], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_bash_completes(script):
    file = script("bash")
    assert in_bash(file, "tetraskel", "sk") == ["skeleton"]
    assert in_bash(file, "tetraskel", "") == [*COMMANDS, "--help", "--version"]
    assert in_bash(file, "tetraskel", "skeleton", "--de") == ["--detail", "--denoise"]
    assert in_bash(file, "tetraskel", "tree", "in.csv", "--centre", "") == list(CENTRES)
    assert in_bash(file, "tetraskel", "tree", "") == []  # bash offers files itself
    assert in_bash(file, "tetraskel", "completion", "f") == ["fish"]


def test_fish_completes(script):
    file = script("fish")
    for line, expected in (("sk", ["skeleton"]), ("tree x --centre ", sorted(CENTRES)), ("completion f", ["fish"])):
        command = f"source {file}; complete -C 'tetraskel {line}'"
        done = subprocess.run(["fish", "--no-config", "-c", command], capture_output=True, text=True, check=True)
        assert sorted(row.split("\t")[0] for row in done.stdout.splitlines()) == expected


def read_until(terminal, wanted, seconds=20):
    """What a terminal shows until the wanted text is there."""
    shown, end = "", time.monotonic() + seconds
    while wanted not in shown and time.monotonic() < end:
        if select.select([terminal], [], [], 0.2)[0]:
            shown += re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", os.read(terminal, 4096).decode(errors="replace"))
    return shown


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("tetraskel ske\t", "tetraskel skeleton "),
        ("tetraskel tree --trav\t", "--traversal"),
        ("tetraskel tree --traversal d\t", "--traversal depth"),
    ],
)
def test_zsh_completes(script, typed, expected):
    file = script("zsh")
    child, terminal = pty.fork()
    if child == 0:
        os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb", "PS1": "> "})
    try:
        os.write(terminal, f"autoload -U compinit; compinit -D -u; source {file}; echo rea''dy\n".encode())
        assert "ready" in read_until(terminal, "ready")
        os.write(terminal, typed.encode())
        assert expected in read_until(terminal, expected)
    finally:
        os.close(terminal)
        os.waitpid(child, 0)
