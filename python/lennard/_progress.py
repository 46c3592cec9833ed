"""How far a run is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

#: Called with the name of the stage, the steps done and the step at which the run ends.
ProgressCallback: TypeAlias = Callable[[str, int, int], object]
Progress: TypeAlias = bool | ProgressCallback


@contextmanager
def told(progress: Progress) -> Iterator[ProgressCallback | None]:
    """The callback for a run: a bar of tqdm where it is installed, the caller's own, or none."""
    if callable(progress):
        yield progress
        return
    bar = _bar() if progress else None
    if bar is None:
        yield None
        return
    try:
        yield bar.tell
    finally:
        bar.close()


def _bar() -> _Bar | None:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Bar(tqdm)


class _Bar:
    """A bar that begins where the run begins."""

    def __init__(self, make: Any) -> None:
        self._make = make
        self._bar: Any = None

    def tell(self, stage: str, done: int, total: int) -> None:
        if self._bar is None:
            self._bar = self._make(total=total, initial=done, unit="step", unit_scale=True)
        self._bar.set_description(stage, refresh=False)
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
