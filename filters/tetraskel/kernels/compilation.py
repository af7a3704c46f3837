"""Whether numba compiles the loops, and where what it compiled is kept: the one place that knows."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import logging
import os
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

SWITCH = "TETRASKEL_NUMBA"  # set to 0 to keep numba out
FOLDER = "TETRASKEL_NUMBA_PATH"  # a folder with numba and llvmlite, for a Python that has none (ParaView's)
BESIDE = "numba_packages"  # the name of such a folder beside the plugin, which needs no variable
CACHE = "NUMBA_CACHE_DIR"  # numba's own variable; respected
KERNELS = Path(__file__).resolve().parent
# modules that compiled loops of other modules take functions or constants from
SHARED = (
    *("compiled_heaps", "barycentric", "passage_widths", "vector_loops"),
    *("voronoi_faces", "voronoi_lines"),
)

logger = logging.getLogger("tetraskel")


_settings = threading.Lock()
_failures: list[BaseException] = []  # why numba is not used although it is there


def numba_is_used() -> bool:
    """Whether loops run compiled: numba is there, works, and is not switched off."""
    return os.environ.get(SWITCH, "1") != "0" and not _failures and _numba_module() is not None


@cache
def _numba_module() -> ModuleType | None:
    """Numba, or None where it is missing; where it is there but broken, with one warning."""
    if importlib.util.find_spec("numba") is None:
        _append_folder()
    if importlib.util.find_spec("numba") is None:
        return None
    try:
        numba = importlib.import_module("numba")
        _announce_compilation()
    except Exception as error:  # whatever a wrong NumPy, a missing llvmlite or half an installation raises
        give_up_numba(error)
        return None
    return numba


def give_up_numba(error: BaseException) -> None:
    """Do without numba from now on, and say so once."""
    _failures.append(error)
    warnings.warn(
        f"numba is installed but does not work ({first_line(error)}); Qhull and uncompiled loops are used instead. "
        f"Repair it, or set {SWITCH}=0.",
        RuntimeWarning,
        stacklevel=3,
    )


def first_line(error: BaseException) -> str:
    """What an exception says, in one line."""
    return (str(error).strip() or type(error).__name__).splitlines()[0]


def _announce_compilation() -> None:
    """Log a line when this process compiles something of ours for the first time; code from disk is not compiled."""
    event = importlib.import_module("numba.core.event")

    class Compiling(event.Listener):  # type: ignore[name-defined,misc]
        told = False

        def on_start(self, started: Any) -> None:
            ours = started.data["dispatcher"].py_func.__module__.startswith("tetraskel")
            if ours and not Compiling.told:
                Compiling.told = True
                logger.warning("tetraskel compiles its loops with numba, once; this takes up to a minute.")

        def on_end(self, ended: Any) -> None:
            pass

    event.register("numba:compile", Compiling())


def _append_folder() -> None:
    """Put a folder that holds numba at the end of the path: nothing in it hides what this Python has."""
    package = KERNELS.parent
    beside = (package.parents[1] / "plugin" / BESIDE, package / "paraview_plugin" / BESIDE)
    for folder in (os.environ.get(FOLDER, ""), *map(str, beside)):
        if os.path.isdir(folder):
            sys.path.append(folder)
            importlib.invalidate_caches()
            return


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function that Python calls; the result is kept on disk."""
    numba = importlib.import_module("numba")
    with _cache_folder(numba):
        return numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=False, _nrt=True)(function)


def compiled_without_arrays(function: Callable[..., Any]) -> Any:
    """The same for a function that makes no arrays: references to those it is given are then not counted.

    Counting costs an atomic operation per array and call, more than most of the functions called.
    """
    numba = importlib.import_module("numba")
    with _cache_folder(numba):
        return numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=False, _nrt=False)(function)


def inner(function: Callable[..., Any]) -> Any:
    """Compile a function that only compiled functions call: it is kept as a part of them."""
    return importlib.import_module("numba").njit(nogil=True, error_model="numpy", forceinline=False, _nrt=True)(
        function
    )


def called(function: Callable[..., Any]) -> Any:
    """Compile a function that only compiled functions call and that makes no arrays; sooner done than `inlined`."""
    return importlib.import_module("numba").njit(nogil=True, error_model="numpy", forceinline=False, _nrt=False)(
        function
    )


def inlined(function: Callable[..., Any]) -> Any:
    """Compile a small function into each compiled function that calls it."""
    return importlib.import_module("numba").njit(nogil=True, error_model="numpy", forceinline=True, _nrt=False)(
        function
    )


@contextmanager
def _cache_folder(numba: ModuleType) -> Iterator[None]:
    """Numba's setting, which is one for all threads, for the functions made inside the block only."""
    with _settings:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(cache_folder())
        try:
            yield
        finally:
            numba.config.CACHE_DIR = before


@cache
def cache_folder() -> Path:
    """A writable folder for compiled code: numba's own choice, else beside the source, the user's, or a temporary one.

    Its last part is a function of numba's version, the source of the exact engine, and what other loops call or take
    constants from: numba looks only at the file of the outermost function to see whether what it kept is out of date.
    """
    version = hashlib.sha256(getattr(_numba_module(), "__version__", "").encode())  # one numba discards another's
    here = Path(__file__)
    shared = [here.with_name(name + ".py") for name in SHARED]
    for file in [here, *shared, *sorted(here.parent.glob("exact/*.py"))]:
        version.update(file.read_bytes())
    name = f"tetraskel-{version.hexdigest()[:16]}"
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or os.path.expanduser("~/.cache")
    given = os.environ.get(CACHE)
    for place in (Path(given),) if given else (KERNELS / "__pycache__", Path(home) / "tetraskel"):
        if _is_writable(place / name):
            return place / name
    return Path(tempfile.mkdtemp(prefix="tetraskel-"))


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
