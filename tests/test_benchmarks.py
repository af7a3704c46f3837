"""The comparison with other programs runs where there are none of them."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_the_comparison_judges_what_is_there_and_says_what_is_not(tmp_path: Path) -> None:
    chosen = ["--python", sys.executable, "--out", tmp_path, "--objects", "y", "--sizes", "1000", "--seconds", "60"]
    chosen += ["--programs", "tetraskel,PyGEL3D LS"]
    command = [sys.executable, ROOT / "benchmarks" / "peers" / "run.py", *chosen]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "filters")}
    subprocess.run(command, check=True, timeout=300, capture_output=True, env=environment)
    rows = (tmp_path / "peers_table.md").read_text().splitlines()
    ours, theirs = ([row for row in rows if f"| 1000 | {name} |" in row] for name in ("tetraskel", "PyGEL3D LS"))
    assert ours[0].startswith("| y | 1000 | tetraskel | 0 (0) | 3 (3) | 1 | 0.9")
    assert "No module named" in theirs[0]
