"""The exceptions a caller can meet, each a sentence: what was expected, what came, what to do."""


class TetraskelError(Exception):
    """Base of everything this package raises on purpose."""


class InputError(TetraskelError, ValueError):
    """Points, options or files that cannot be used as they are."""


class NoInsideError(InputError):
    """An object was to be drawn, and nothing lies inside."""


class MeshError(InputError):
    """A mesh whose cells do not form a triangulation this package can walk."""


class EngineError(TetraskelError, RuntimeError):
    """A triangulation engine that is missing or failed."""


class RankError(TetraskelError, RuntimeError):
    """Another rank of a run on several failed; says which, and what it said."""


class Aborted(TetraskelError):
    """The user asked to stop; nothing was produced."""


class InsideWarning(UserWarning):
    """Nothing lies inside; says why, and which option to try."""
