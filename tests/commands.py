"""Commands of the shell, run in this process: what a script of theirs would see."""

from __future__ import annotations

from tetraskel.cli import main


def run(capsys, *arguments):
    """Status, standard output and standard error of a command."""
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as leave:
        status = leave.code
    told = capsys.readouterr()
    return status, told.out, told.err
