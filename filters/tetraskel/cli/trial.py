"""Files from strangers: tried in a process of their own first, because VTK's readers crash on some broken ones."""

from __future__ import annotations

import faulthandler
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from tetraskel.errors import InputError

# What a reader may take. The text of a number is shorter than what it becomes, and compressed blocks may be a thousand
# times shorter; but a file of some bytes that asks for gigabytes has a broken header.
LEAST_BYTES = 1 << 30
BYTES_PER_BYTE = 200
LEAST_SECONDS = 10
BYTES_PER_SECOND = 1 << 20
FAILED = 3  # exit status
LONGEST_REASON = 4000  # bytes; a pipe takes so many without a reader
LONGEST_WAIT = 0.02  # seconds between two looks


def try_to_read(file: Path, read: Callable[[], object]) -> None:
    """Read a file in a forked process with bounded memory and time; where there is no fork, nothing is tried.

    Raises
    ------
    InputError
        With the sentence of an `InputError` of `read`; or when the process crashed, or wanted more memory or time than
        such a file can be worth.
    """
    if not hasattr(os, "fork"):
        return
    size = file.stat().st_size
    broken = f"{str(file)!r} cannot be read as {file.suffix}: "
    sys.stdout.flush()
    sys.stderr.flush()
    told, tell = os.pipe()
    child = os.fork()
    if child == 0:
        _read_and_leave(read, LEAST_BYTES + BYTES_PER_BYTE * size, tell)
    os.close(tell)
    status = _status_of(child, LEAST_SECONDS + size / BYTES_PER_SECOND)
    with open(told, encoding="utf-8") as pipe:
        reason = pipe.read()
    if status is None:
        raise InputError(broken + "reading takes too long; its header may lie.")
    if reason:
        raise InputError(reason)
    if status != 0:
        raise InputError(broken + "it is broken, or its header promises more than it holds.")


def _read_and_leave(read: Callable[[], object], n_bytes: int, tell: int) -> None:
    """In the forked process: read, tell why it fails, and end without any of the parent's business."""
    code = FAILED
    faulthandler.disable()  # a crash here is an answer, not news
    try:
        with open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), 1)
            os.dup2(nowhere.fileno(), 2)
        _limit(n_bytes)
        read()
        code = 0
    except InputError as error:
        os.write(tell, str(error).encode("utf-8", "replace")[:LONGEST_REASON])
    finally:
        os._exit(code)


def _limit(n_bytes: int) -> None:
    """Bound the memory of this process to what it has and so many bytes more; no core is left behind."""
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").is_file() else 0
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if pages:
        most = pages * resource.getpagesize() + n_bytes
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _status_of(child: int, seconds: float) -> int | None:
    """How a process ended; None when it had to be ended."""
    import signal

    until, wait = time.monotonic() + seconds, 0.001
    while time.monotonic() < until:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        time.sleep(wait)
        wait = min(2 * wait, LONGEST_WAIT)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None
