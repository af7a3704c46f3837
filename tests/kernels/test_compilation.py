"""When numba is used, where what it compiles is kept, and what happens when it does not work."""

from __future__ import annotations

import subprocess
import sys
import time
import types
from concurrent.futures import ThreadPoolExecutor

import pytest

from paths import ENVIRONMENT
from tetraskel.kernels import compilation
from tetraskel.kernels.compilation import CACHE, FOLDER, SWITCH, numba_is_used

NEEDS_NUMBA = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")
CLOUD = """
import sys, numpy as np
from tetraskel import triangulate
print(triangulate(np.random.default_rng(0).random((20, 2))).engine)
"""

ORDER = """
import numpy as np
from tetraskel.kernels.compilation import numba_is_used
assert numba_is_used()
from tetraskel.kernels.exact.ordering import insertion_order
print(insertion_order(np.random.default_rng(0).random((20, 2)), 0).sum())
"""  # a small part of the engine: to compile all of it takes long


def run(folder, code=CLOUD, **more):
    """A program with an empty cache of its own; gives its output and its errors."""
    environment = {**ENVIRONMENT, CACHE: str(folder / "cache"), **more}
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=500)


def test_threads_that_compile_at_once_leave_numbas_own_setting_as_it_was(monkeypatch):
    settings = types.SimpleNamespace(CACHE_DIR="numba's own")

    def njit(**options):
        time.sleep(0.05)  # all threads come here before the first one leaves
        return lambda function: settings.CACHE_DIR

    monkeypatch.setitem(sys.modules, "numba", types.SimpleNamespace(config=settings, njit=njit))
    monkeypatch.setattr(compilation, "cache_folder", lambda: "ours")
    with ThreadPoolExecutor(4) as threads:
        assert set(threads.map(compilation.compiled, [run] * 4)) == {"ours"}
    assert settings.CACHE_DIR == "numba's own"


def test_numba_can_be_switched_off(monkeypatch):
    monkeypatch.setenv(SWITCH, "0")
    assert not numba_is_used()


def test_a_numba_that_cannot_be_imported_costs_one_warning(tmp_path):
    (tmp_path / "numba.py").write_text("raise ImportError('llvmlite is older than this')")
    path = {"PYTHONPATH": f"{tmp_path}:{ENVIRONMENT['PYTHONPATH']}"}
    done = run(tmp_path, CLOUD + "print(triangulate(np.eye(3)).engine)", **path)
    assert done.stdout.split() == ["qhull", "qhull"]
    assert done.stderr.count("numba is installed but does not work (llvmlite is older than this)") == 1


def test_a_folder_with_numba_is_found_and_hides_nothing(tmp_path, monkeypatch):
    """The folder comes last on the path, and only where there is no numba."""
    (tmp_path / "numba.py").write_text("")
    (tmp_path / "numpy.py").write_text("raise ImportError('the wrong numpy')")
    monkeypatch.setenv(FOLDER, str(tmp_path))
    monkeypatch.setattr(sys, "path", list(sys.path))
    compilation._append_folder()
    assert sys.path[-1] == str(tmp_path)


@NEEDS_NUMBA
def test_two_first_runs_at_once_announce_compilation_and_a_later_one_does_not(tmp_path):
    environment = {**ENVIRONMENT, CACHE: str(tmp_path / "cache")}
    command = [sys.executable, "-c", ORDER]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment}
    both = [subprocess.Popen(command, **pipes) for _ in range(2)]
    for one in both:
        out, err = one.communicate(timeout=500)
        assert out.split() == ["190"]
        assert err.count("tetraskel compiles its loops with numba, once") == 1
    later = run(tmp_path, ORDER)
    assert (later.stdout.split(), later.stderr) == (["190"], "")


@pytest.mark.parametrize("blocked", [False, True])
def test_what_is_compiled_is_kept_where_one_can_write(tmp_path, monkeypatch, blocked):
    monkeypatch.delenv(CACHE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(compilation, "KERNELS", tmp_path / "a file")  # no folder can be made below a file
    (tmp_path / "a file").write_text("")
    if blocked:
        (tmp_path / "home").write_text("")
    folder = compilation.cache_folder.__wrapped__()
    assert folder.is_dir()
    assert (tmp_path / "home" in folder.parents) != blocked
