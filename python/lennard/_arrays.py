"""Arrays of a caller, as the compiled part takes them: real numbers in double precision, none of them masked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from ._tables import Floats


#: Three sides of a box along x, y and z, σ.
Sides: TypeAlias = tuple[float, float, float]


def numbers(name: str, given: Any, allowed: str = "real numbers, none of them masked") -> Floats:
    """An array of real numbers, of any shape; ``ValueError`` names the array where it is none."""

    def refused(found: str) -> ValueError:
        return ValueError(f"{name} must be real numbers\n  found:   {found}\n  allowed: {allowed}")

    if isinstance(given, np.ma.MaskedArray):
        if masked := int(np.count_nonzero(np.ma.getmaskarray(given))):
            raise refused(f"{masked} masked of {given.size} entries")
        given = given.data
    try:
        array = np.asarray(given)
    except (ValueError, TypeError, RecursionError):
        raise refused("lists of unequal lengths, or something else in a list") from None
    if array.dtype.kind not in "iuf":
        raise refused(f"entries of the type {array.dtype}")
    floats: Floats = array.astype(np.float64, copy=False)
    return floats


def number(name: str, given: Any) -> float:
    """One real number."""
    array = numbers(name, given, "one real number")
    if array.ndim:
        raise ValueError(f"{name} has the shape {array.shape}\n  allowed: one real number")
    return float(array)


def sides(name: str, given: Any) -> Sides:
    """The sides of a box: one for a cube, or three."""
    array = numbers(name, given)
    if array.shape not in [(), (1,), (3,)]:
        raise ValueError(f"{name} has the shape {array.shape}\n  allowed: one side, or three sides along x, y and z")
    x, y, z = np.broadcast_to(array, (3,)).tolist()
    return (x, y, z)


def vectors(name: str, given: Any, *, check: bool = True) -> Floats:
    """Vectors of particles, ``[N, 3]``; ``check`` refuses numbers that are not finite, where nothing later does."""
    array = numbers(name, given, "an array (N, 3) of real numbers, none of them masked")
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ValueError(f"{name} has the shape {array.shape}\n  allowed: (N, 3), N of at least 1")
    if check and len(wrong := np.flatnonzero(~np.isfinite(array).all(axis=1))):
        raise ValueError(f"{name} hold what is not a finite number\n  found:   particle {wrong[0]}, counted from 0")
    return array
