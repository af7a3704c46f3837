"""Command-line options written from the option sets."""

from __future__ import annotations

import argparse
from dataclasses import fields

from tetraskel.options import Options


def add_options(parser: argparse.ArgumentParser, *option_sets: type[Options]) -> None:
    """One `--name` for every option, with its default, unit and meaning; none for those a command asks otherwise.

    Of several options with one name the first counts.
    """
    seen: set[str] = set()
    for options in option_sets:
        group = parser.add_argument_group(options.__doc__.rstrip("."))
        for declared in _asked(options):
            if _name(declared) not in seen:
                _add_option(group, declared)
            seen.add(_name(declared))


def _asked(options: type[Options]) -> list:
    return [declared for declared in fields(options) if declared.metadata["flag"] is not None]


def _add_option(group, declared) -> None:
    metadata = declared.metadata
    unit = f" [{metadata['unit']}]" if metadata["unit"] else ""
    common = {"default": declared.default, "help": (metadata["doc"] + unit).replace("%", "%%")}
    flag = "--" + _name(declared).replace("_", "-")
    if isinstance(declared.default, bool):
        group.add_argument(flag, action=argparse.BooleanOptionalAction, **common)
    elif isinstance(declared.default, tuple):
        group.add_argument(flag, type=float, nargs=len(declared.default), metavar="FLOAT", **common)
    elif metadata["choices"]:
        group.add_argument(flag, choices=metadata["choices"], **common)
    else:
        kind = type(declared.default)
        group.add_argument(flag, type=kind, metavar=kind.__name__.upper(), **common)


def _name(declared) -> str:
    return declared.metadata["flag"] or declared.name


def values(chosen: argparse.Namespace, options: type[Options]) -> dict:
    """The values of one option set among the parsed arguments, checked."""
    picked = {declared.name: getattr(chosen, _name(declared)) for declared in _asked(options)}
    options(**picked)
    return picked
