"""Whether numba compiles the loops, and where what it compiled is kept: the one place that knows."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import logging
import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

SWITCH = "TETRASKEL_NUMBA"  # set to 0 to keep numba out
FOLDER = "TETRASKEL_NUMBA_PATH"  # a folder with numba and llvmlite, for a Python that has none (ParaView's)
CACHE = "NUMBA_CACHE_DIR"  # numba's own variable; respected
KERNELS = Path(__file__).resolve().parent

logger = logging.getLogger("tetraskel")


def numba_is_used() -> bool:
    """Whether loops run compiled: numba is there, can be imported, and is not switched off."""
    return os.environ.get(SWITCH, "1") != "0" and numba_module() is not None


@cache
def numba_module() -> ModuleType | None:
    """Numba, or None where it is missing; where it is there but broken, with one warning."""
    _append_folder()
    if importlib.util.find_spec("numba") is None:
        return None
    try:
        return importlib.import_module("numba")
    except Exception as error:  # whatever a wrong NumPy, a missing llvmlite or half an installation raises
        warn_of_broken_numba(error)
        return None


def warn_of_broken_numba(error: BaseException) -> None:
    """One sentence about a numba that cannot be used, and what happens instead."""
    reason = (str(error).strip() or type(error).__name__).splitlines()[0]
    warnings.warn(
        f"numba is installed but does not work ({reason}); Qhull and uncompiled loops are used instead. "
        f"Repair it, or set {SWITCH}=0.",
        RuntimeWarning,
        stacklevel=3,
    )


def _append_folder() -> None:
    """Put the folder that holds numba for this Python at the end of the path: nothing in it hides what is there."""
    folder = os.environ.get(FOLDER, "")
    if folder and os.path.isdir(folder) and folder not in sys.path:
        sys.path.append(folder)
        importlib.invalidate_caches()


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
    return importlib.import_module("numba").njit(nogil=True, error_model="numpy", forceinline=False, _nrt=True)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """Compile a small function into each compiled function that calls it."""
    return importlib.import_module("numba").njit(nogil=True, error_model="numpy", forceinline=True, _nrt=False)(function)


@contextmanager
def announced(numba: ModuleType, message: str) -> Iterator[None]:
    """Log `message` once if anything has to be compiled inside the block, and nothing if all comes from disk."""
    event = importlib.import_module("numba.core.event")

    class Compiling(event.Listener):  # type: ignore[name-defined,misc]
        told = False

        def on_start(self, _: Any) -> None:
            if not self.told:
                self.told = True
                logger.warning(message)

        def on_end(self, _: Any) -> None:
            pass

    with event.install_listener("numba:compile", Compiling()):
        yield


@contextmanager
def _cache_folder(numba: ModuleType) -> Iterator[None]:
    """Numba's setting for the functions made inside the block only."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder())
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before


@cache
def cache_folder() -> Path:
    """A writable folder for compiled code: numba's own choice, else beside the source, the user's, or a temporary one.

    Its last part is a function of the kernels' source, because numba looks only at the file of the outermost
    function to see whether what it kept is out of date.
    """
    version = hashlib.sha256()
    for file in sorted(KERNELS.rglob("*.py")):
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
