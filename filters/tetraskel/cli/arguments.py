"""Command-line options written from the option sets."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from dataclasses import fields

from tetraskel.cli.outputs import InputFile, OutputFile
from tetraskel.errors import InputError
from tetraskel.options import Options


def add_input(parser: argparse.ArgumentParser, kinds: str) -> None:
    """IN, once or more; with several, OUT is a folder."""
    parser.add_argument(
        "input", metavar="IN", type=InputFile, nargs="+", help=f"{kinds}; with several, OUT is a folder"
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """The summary for scripts."""
    several = any(action.nargs == "+" for action in parser._actions)
    each = ", one for each input" if several else ""
    parser.add_argument("--json", action="store_true", help=f"print what was done as a line of JSON{each}")


def add_points_only(parser: argparse.ArgumentParser) -> None:
    """What takes a mesh for its points."""
    parser.add_argument(
        "--points-only", action="store_true", help="triangulate the points even if the file holds tetrahedra"
    )


def add_drawings(parser: argparse.ArgumentParser, how: str = "also ") -> None:
    """Pictures of the result."""
    parser.add_argument("--png", metavar="FILE", type=OutputFile, help=f"{how}draw the result, off screen")
    parser.add_argument(
        "--html", metavar="FILE", type=OutputFile, help=f"{how}write a page that turns the result in a browser"
    )


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
    flag = _flag(_name(declared))
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


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def names_of(*option_sets: type[Options]) -> list[str]:
    """What the options of these sets are called among the parsed arguments."""
    return [_name(declared) for options in option_sets for declared in _asked(options)]


def values(chosen: argparse.Namespace, options: type[Options]) -> dict:
    """The values of one option set among the parsed arguments, checked."""
    picked = {declared.name: getattr(chosen, _name(declared)) for declared in _asked(options)}
    options(**picked)
    _expect_of_use(chosen, options)
    return picked


def _expect_of_use(chosen: argparse.Namespace, options: type[Options]) -> None:
    """Raise `InputError` for an option that was given and matters only where another one is not what it is."""
    asked = {declared.name: declared for declared in _asked(options)}
    for declared in asked.values():
        other, word = declared.metadata["when"] or ("", "")
        if other not in asked:
            continue
        name = _name(asked[other])
        if getattr(chosen, name) != type(asked[other].default)(word):
            refuse(chosen, [_name(declared)], f"{_flag(name)} {word}", f"{_flag(name)} {{{name}}}")


def refuse(chosen: argparse.Namespace, names: Iterable[str], needed: str, instead: str) -> None:
    """Raise `InputError` when one of these options was given, which do nothing without the `needed` words.

    `instead` is what the call has, with the values of options in braces.
    """
    idle = [_flag(name) for name in names if name in chosen.given]
    if idle:
        got = instead.format(**vars(chosen))
        out = idle[0] if len(idle) == 1 else "them"
        raise InputError(f"expected {', '.join(idle)} with {needed} only, got {got}; leave {out} out.")
