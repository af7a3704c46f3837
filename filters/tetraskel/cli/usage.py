"""How the commands are parsed and how their help reads."""

from __future__ import annotations

import argparse
import difflib
import sys
import textwrap
from collections.abc import Iterable, Sequence

BAD_USAGE = 2


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage text, and what may have been meant."""

    def parse_args(self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None):
        """The arguments of a command; what it does not know is its own error."""
        words, commands = sys.argv[1:] if args is None else list(args), commands_of(self)
        first = next((word for word in words if not word.startswith("-")), None)
        if first is not None and commands and first not in commands:
            self.error(f"invalid choice: {first!r}, expected one of {', '.join(commands)}{meant(first, commands)}")
        chosen, unknown = self.parse_known_args(words, namespace)
        if unknown:
            asked = commands.get(first, self)
            flags = [flag for action in asked._actions for flag in action.option_strings]
            guesses = [meant(word.split("=")[0], flags) for word in unknown if word.startswith("-")]
            asked.error(f"unrecognized arguments: {' '.join(unknown)}{next(filter(None, guesses), '')}")
        return chosen

    def error(self, message: str) -> None:
        """Print one line and leave with status 2."""
        self.exit(BAD_USAGE, f"{self.prog}: {message} (see {self.prog} --help).\n")


class HelpForm(argparse.ArgumentDefaultsHelpFormatter):
    """Paragraphs are filled, lines that begin with two blanks stay; defaults only where there is one to tell."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        paragraphs = [part for part in text.strip("\n").split("\n\n") if part.strip()]
        return "\n\n".join(_filled(part, width, indent) for part in paragraphs)

    def _get_help_string(self, action: argparse.Action) -> str:
        if isinstance(action, argparse.BooleanOptionalAction) and action.default is not None:
            return f"{action.help} (default: {'on' if action.default else 'off'})"
        if action.default is None or action.nargs == 0:
            return action.help or ""
        return super()._get_help_string(action)


def _filled(paragraph: str, width: int, indent: str) -> str:
    lines = paragraph.splitlines()
    if any(line.startswith("  ") for line in lines):
        return "\n".join(indent + line for line in lines)
    return textwrap.fill(" ".join(lines), width, initial_indent=indent, subsequent_indent=indent)


def told(examples: Iterable[tuple[str, str]]) -> str:
    """Examples as the end of a help text: what for, and the command."""
    pairs = [f"  {meaning}\n    tetraskel {command}" for meaning, command in examples]
    return "\n\n".join(["Examples:", *pairs])


def shorten(parser: argparse.ArgumentParser) -> None:
    """Leave the list of all options out of the first line of the help; it stands below."""
    places = [action for action in parser._actions if not action.option_strings]
    words = [f"{place.metavar} [{place.metavar} ...]" if place.nargs == "+" else place.metavar for place in places]
    parser.usage = " ".join(["%(prog)s", *words, "[options]"])


def meant(word: str, known: Iterable[str]) -> str:
    """The end of a sentence about a word that is not known."""
    near = difflib.get_close_matches(word, list(known), n=1)
    return f"; did you mean {near[0]}?" if near else ""


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Every command with its parser."""
    return next((action.choices for action in parser._actions if isinstance(action.choices, dict)), {})


def given(parser: argparse.ArgumentParser, arguments: Sequence[str] | None) -> frozenset[str]:
    """Names of what stands in the arguments, which can be parsed; the parser loses its defaults."""
    for command in commands_of(parser).values():
        command._defaults.clear()
        for action in command._actions:
            action.default = argparse.SUPPRESS
    return frozenset(vars(parser.parse_args(arguments)))
