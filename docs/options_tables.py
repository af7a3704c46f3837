"""MkDocs asks this hook for the tables of parameters: they are made from the options, so they cannot be others.

A page asks by a line `<!-- options: NAME -->` with the name of a filter or of a class in `tetraskel.options`.
"""

from __future__ import annotations

import math
import re
from dataclasses import fields

from tetraskel import options, vtkfilters

MARK = re.compile(r"^<!-- options: (\w+) -->$", re.MULTILINE)


def on_page_markdown(markdown: str, **_) -> str:
    """Called by MkDocs for every page."""
    return MARK.sub(lambda found: table_of(found[1]), markdown)


def table_of(name: str) -> str:
    """The options of a filter or of an option set, in Markdown."""
    declared = options_of(name)
    if not fields(declared):
        return "None."
    rows = [row_of(option) for option in fields(declared)]
    return "\n".join(["| option | default | values | meaning |", "|---|---|---|---|", *rows])


def options_of(name: str) -> type[options.Options]:
    """The option set of that name, or of the filter of that name."""
    return getattr(options, name) if hasattr(options, name) else getattr(vtkfilters, name).options


def row_of(option) -> str:
    """A row: name with the flag of the shell where that is another, default, values, meaning."""
    metadata = option.metadata
    flag = metadata["flag"]
    name = f"`{option.name}`" + (f"<br>shell: `--{flag}`" if flag else "")
    when = metadata["when"]
    only = f" For `{when[0]}` = `{words_of(when[1])}`." if when else ""
    cells = (name, f"`{option.default!r}`", values_of(option), metadata["doc"] + only)
    return "| " + " | ".join(cell.replace("|", "&#124;") for cell in cells) + " |"


def words_of(word: str) -> str:
    """A word as it is typed; a switch that is on is 1 in panels."""
    return {"1": "True"}.get(word, word)


def values_of(option) -> str:
    """What an option takes, with its unit."""
    metadata = option.metadata
    if metadata["choices"]:
        return ", ".join(f"`{word}`" for word in metadata["choices"])
    unit = f" [{metadata['unit']}]" if metadata["unit"] else ""
    if isinstance(option.default, bool):
        return "`True`, `False`"
    if metadata["bounds"]:
        low, high = metadata["bounds"]
        return (f"from {low:g}" if high == math.inf else f"{low:g} to {high:g}") + unit
    return {str: "a name", tuple: "coordinates"}[type(option.default)] + unit
