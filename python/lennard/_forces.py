"""Forces and energies at positions that a caller moves, without a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _lennard, _toml
from ._tables import Floats

#: A box may change by this share of each side before its list is planned anew.
_SAME_BOX = 0.1


class Evaluation(NamedTuple):
    """Forces at some positions, with the energy, and what else was asked for."""

    #: F = −∂U/∂r, ``[N, 3]``, ε/σ.
    forces: Floats
    #: U of the system in ε, with the tail where the truncation has one.
    energy: float
    #: W = Σ r_ij ⊗ F_ij, ``[3, 3]``, ε, with the tail; ``None`` unless asked for.
    virial: Floats | None
    #: The energy of each particle, ``[N]``, ε, with its part of the tail; ``None`` unless asked for.
    energies: Floats | None


class Forces:
    """Pair forces in a periodic box: positions in, forces and energies out.

    >>> import lennard
    >>> forces = lennard.Forces(10.0, truncation="shift")
    >>> forces([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0]])[0, 0]
    -24.0

    ``box`` is one side or three, σ. ``potential`` is a name or a table (``lennard.potential.mie(repulsive=12)``), and so is
    ``truncation``. ``neighbor`` and ``kernel`` are tables too (``kernel={"precision": "mixed"}``). Keys and defaults are those
    of a scene. All particles are of one species.

    The neighbor list is kept between calls, and built anew where particles have moved too far. A box that changes comes with
    the positions. Another number of particles, or a side that differs by more than a tenth, plans the list anew.
    """

    def __init__(
        self,
        box: ArrayLike,
        potential: str | Mapping[str, Any] | None = None,
        *,
        truncation: str | Mapping[str, Any] | None = None,
        neighbor: Mapping[str, Any] | None = None,
        kernel: Mapping[str, Any] | None = None,
        threads: int | None = None,
    ) -> None:
        self._sides = _arrays.sides("box", box)
        given = {"potential": potential, "truncation": truncation, "neighbor": neighbor, "kernel": kernel}
        self._tables = {
            name: {"kind": table} if isinstance(table, str) else dict(table)
            for name, table in given.items()
            if table is not None
        }
        self._threads = threads
        self._evaluator: _lennard.Evaluator | None = None
        self._made_for: tuple[int, _arrays.Sides] | None = None

    def __call__(self, positions: ArrayLike, box: ArrayLike | None = None) -> Floats:
        """The forces alone, ``[N, 3]``, ε/σ, at positions ``[N, 3]``, σ, which need not lie in the box."""
        return self._found(positions, box, False, False, False)[1]

    def evaluate(
        self,
        positions: ArrayLike,
        box: ArrayLike | None = None,
        *,
        virial: bool = False,
        energies: bool = False,
    ) -> Evaluation:
        """Forces and energy; the virial tensor and the energies of particles where they are asked for."""
        energy, forces, tensor, each = self._found(positions, box, True, virial, energies)
        return Evaluation(forces, energy, tensor, each)

    @property
    def builds(self) -> int:
        """Builds of the neighbor list so far."""
        return 0 if self._evaluator is None else self._evaluator.builds

    def _found(
        self, positions: ArrayLike, box: ArrayLike | None, energy: bool, virial: bool, each: bool
    ) -> tuple[float, Floats, Floats | None, Floats | None]:
        places = _arrays.vectors("positions", positions, check=False)
        if box is not None:
            self._sides = _arrays.sides("box", box)
        return self._evaluator_for(len(places)).evaluate(places, self._sides, energy, virial, each)

    def _evaluator_for(self, n: int) -> _lennard.Evaluator:
        """What was made before, where it serves so many particles in the present box."""
        if self._evaluator is not None and self._made_for is not None:
            made_n, made_for = self._made_for
            changed = (abs(side / made - 1.0) for side, made in zip(self._sides, made_for))
            if made_n == n and max(changed) < _SAME_BOX:
                return self._evaluator
        scene = {
            "system": {"n_atoms": n, "box": self._sides, "temperature": 1.0},
            # Where particles of a scene begin does not matter here.
            "start": {"kind": "random"},
            **self._tables,
        }
        self._evaluator = _lennard.Evaluator(_toml.document(scene), n, self._sides, self._threads)
        self._made_for = (n, self._sides)
        return self._evaluator

    def __getstate__(self) -> dict[str, Any]:
        # The list is made anew where the copy is used.
        return {**self.__dict__, "_evaluator": None, "_made_for": None}
