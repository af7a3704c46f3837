"""What is known of a sample: plain numbers and lists, and the file that holds them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Answers = dict[str, Any]
Sample = tuple[Floats, Answers]


def rounded(value: float) -> float:
    """A number to 12 decimals, so that the last bits of a machine's cosine do not reach the file."""
    return round(float(value), 12) + 0.0  # + 0.0 makes -0.0 positive


def listed(values: ArrayLike) -> list:
    """An array as nested lists of rounded numbers."""
    return (np.round(np.asarray(values, dtype=float), 12) + 0.0).tolist()


def write_answers(path: Path, answers: dict[str, Answers]) -> None:
    """Answers as JSON, one line per value."""
    blocks = []
    for name, known in answers.items():
        lines = ",\n".join(f"    {json.dumps(key)}: {json.dumps(value)}" for key, value in known.items())
        blocks.append(f"  {json.dumps(name)}: {{\n{lines}\n  }}")
    path.write_text("{\n" + ",\n".join(blocks) + "\n}\n", encoding="utf-8", newline="\n")
