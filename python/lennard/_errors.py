"""What can go wrong, as exceptions."""

from __future__ import annotations


class LennardError(Exception):
    """Every error of this package."""


class SceneError(LennardError, ValueError):
    """A scene that cannot be used. The message is the message of the command line.

    ``file``, ``line``, ``key``, ``problem``, ``found``, ``allowed`` and ``nearest`` hold its parts. A part that
    does not apply is ``None``. A scene from a dictionary has no lines.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
        problem: str | None = None,
        found: str | None = None,
        allowed: str | None = None,
        nearest: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key
        self.problem = problem
        self.found = found
        self.allowed = allowed
        self.nearest = nearest


class PhysicsError(LennardError, RuntimeError):
    """Physics stopped a run: an overlap, a run-away, a number that is not finite. The message says the likely cause."""

    def __init__(
        self,
        message: str,
        *,
        step: int | None = None,
        time: float | None = None,
        stage: str | None = None,
    ) -> None:
        super().__init__(message)
        self.step = step
        self.time = time
        self.stage = stage


class ConfigurationError(LennardError, ValueError):
    """A start configuration that cannot be read."""


class CheckpointError(LennardError, ValueError):
    """A saved simulation that cannot go on here."""


class FolderError(LennardError, OSError):
    """An output folder that cannot be made or is not free."""


class BusyError(LennardError, RuntimeError):
    """The simulation is in use: by a run in another thread, or by an open view."""
