"""Nasty clouds and broken files through every face; invariants are the judge.

`make fuzz` runs it for hours: FUZZ_EXAMPLES says how many examples each test takes, FUZZ_SECONDS for how long.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import broken
import contracts
import faces
import nasty

EXAMPLES = int(os.environ.get("FUZZ_EXAMPLES", "150"))
SECONDS = float(os.environ.get("FUZZ_SECONDS", "5"))  # for each test; what is left is passed over
LONG = EXAMPLES > 1000

fuzzing = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=not LONG,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate, Phase.shrink] if LONG else [Phase.generate],
)


class Count:
    """Cases of one test, and its time."""

    def __init__(self) -> None:
        self.ended = {"result": 0, "error": 0}
        self.until = time.monotonic() + SECONDS

    def over(self) -> bool:
        return time.monotonic() > self.until and sum(self.ended.values()) >= 20


@pytest.fixture(scope="module")
def counts():
    made: dict[str, Count] = {}
    yield made
    told = {name: count.ended for name, count in made.items()}
    print(f"\nfuzzed: {sum(sum(ended.values()) for ended in told.values())} cases, {told}")


def test_functions(counts):
    count = counts["functions"] = Count()

    @fuzzing
    @given(nasty.clouds(), st.sampled_from(sorted(contracts.PROBES)))
    def check(cloud, probe):
        if not count.over():
            count.ended[contracts.kept(contracts.PROBES[probe], cloud)] += 1

    check()
    assert min(count.ended.values()) > 0  # neither all refused nor all taken


def test_filters(counts):
    count = counts["filters"] = Count()

    @fuzzing
    @given(nasty.clouds(30))
    def check(cloud):
        if not count.over():
            count.ended[faces.filtered(cloud)] += 1

    check()
    assert min(count.ended.values()) > 0


def test_commands(counts):
    count = counts["commands"] = Count()

    @fuzzing
    @given(nasty.clouds(30))
    def check(cloud):
        if not count.over():
            with tempfile.TemporaryDirectory() as folder:
                count.ended[faces.commanded(cloud, Path(folder))] += 1

    check()
    assert min(count.ended.values()) > 0


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return broken.whole_files(folder)


def test_broken_files(counts, whole, tmp_path):
    count = counts["files"] = Count()

    @fuzzing
    @given(st.integers(0, 1 << 30))
    def check(seed):
        if count.over():
            return
        rng = np.random.default_rng(seed)
        file = whole[rng.integers(len(whole))]
        folder = tmp_path / "one"
        shutil.rmtree(folder, ignore_errors=True)  # that of a case that failed
        folder.mkdir()
        to = folder / f"x{file.suffix}"
        broken.spoilt(file, to, rng)
        commands = (
            ["surface", "bezier"] if file.suffix == ".swc" else ["tree", "skeleton", "surface", "raster", "measure"]
        )
        command = str(rng.choice(commands))
        out = to if command == "measure" else folder / "out.vtp"
        count.ended[faces.told([command, str(to), str(out)])] += 1

    check()
    assert count.ended["error"] > 0
