"""A progress line on a terminal, nothing in a pipe."""

from __future__ import annotations

import sys
import time

WIDTH = 30
TEXT = 30  # the longest stage
QUIET_SECONDS = 0.5


class ProgressLine:
    """Shows the progress of VTK filters on standard error; a context manager that clears its line at the end.

    It is drawn on a terminal only, once the work has taken a moment; `always` draws it at once and anywhere.
    """

    def __init__(self, stream=None, *, always=False):
        self.stream = sys.stderr if stream is None else stream
        self.always = always
        self.started = time.monotonic()
        self.shown = False

    def watch(self, algorithm) -> None:
        """Follow one filter."""
        algorithm.AddObserver(
            "ProgressEvent", lambda *_: self.show(algorithm.GetProgressText(), algorithm.GetProgress())
        )

    def show(self, stage: str | None, share: float) -> None:
        """Draw the line, once the work has taken long enough to wonder."""
        wanted = self.stream.isatty() and time.monotonic() - self.started >= QUIET_SECONDS
        if not wanted and not self.always:
            return
        bar = "#" * int(share * WIDTH)
        self.stream.write(f"\r{bar:<{WIDTH}} {100 * share:3.0f}% {stage or '':<{TEXT}}")
        self.stream.flush()
        self.shown = True

    def __enter__(self) -> ProgressLine:
        return self

    def __exit__(self, *_) -> None:
        if self.shown:
            self.stream.write("\r" + " " * (WIDTH + len(" 100% ") + TEXT) + "\r")
            self.stream.flush()
