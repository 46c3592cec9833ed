"""Frames of a trajectory in memory, and other packages' objects made from them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._tables import Floats

if TYPE_CHECKING:
    import ase
    import MDAnalysis
    import mdtraj


class Frames:
    """Frames, in reduced units: ``positions`` are ``[F, N, 3]`` and unwrapped, ``box`` is ``[F, 3]``.

    ``velocities`` and ``forces`` are ``None`` where the scene's output does not have them.
    """

    def __init__(
        self,
        *,
        step: NDArray[np.uint64],
        time: Floats,
        box: Floats,
        positions: Floats,
        velocities: Floats | None = None,
        forces: Floats | None = None,
        elements: Sequence[str] | None = None,
        sites_per_molecule: int = 1,
    ) -> None:
        self.step = step
        self.time = time
        self.box = box
        self.positions = positions
        self.velocities = velocities
        self.forces = forces
        #: The element symbol of each particle.
        self.elements = list(elements) if elements is not None else ["Ar"] * positions.shape[1]
        #: Consecutive particles that are folded into the box together.
        self.sites_per_molecule = sites_per_molecule

    @classmethod
    def _of(cls, raw: dict[str, Any], elements: Sequence[str], sites: int) -> Frames:
        return cls(elements=elements, sites_per_molecule=sites, **raw)

    def __len__(self) -> int:
        return len(self.step)

    def __repr__(self) -> str:
        n = self.positions.shape[1] if len(self) else 0
        return f"<{len(self)} frames of {n} particles>"

    @property
    def wrapped(self) -> Floats:
        """Positions folded into the box, ``[F, N, 3]``; the sites of a molecule together, by the first, unless ``output.whole``
        is false."""
        box = self.box[:, None, :]
        images = np.floor(self.positions[:, :: self.sites_per_molecule] / box)
        folded: Floats = self.positions - box * np.repeat(images, self.sites_per_molecule, axis=1)
        return folded

    def to_ase(self, *, sigma: float = 1.0, epsilon: float = 1.0) -> list[ase.Atoms]:
        """A list of ``ase.Atoms``, lengths times ``sigma`` Å. Needs ase.

        Momenta are not set, since ASE takes the mass of the element. The array ``velocities`` has reduced velocities
        times √``epsilon``. The array ``forces`` has reduced forces times ``epsilon``/``sigma``.
        """
        import ase

        images = []
        for i in range(len(self)):
            atoms = ase.Atoms(
                self.elements,
                positions=self.positions[i] * sigma,
                cell=self.box[i] * sigma,
                pbc=True,
                info={"step": int(self.step[i]), "time": float(self.time[i])},
            )
            if self.velocities is not None:
                atoms.set_array("velocities", self.velocities[i] * np.sqrt(epsilon))
            if self.forces is not None:
                atoms.set_array("forces", self.forces[i] * (epsilon / sigma))
            images.append(atoms)
        return images

    def to_mdtraj(self, *, sigma: float = 1.0) -> mdtraj.Trajectory:
        """An ``mdtraj.Trajectory`` with cell and times, lengths times ``sigma`` nm. Needs mdtraj.

        mdtraj holds single precision. With ``sigma=0.3405`` the numbers are nanometres of argon; by default one σ is
        one nanometre.
        """
        import mdtraj

        topology = mdtraj.Topology()
        chain = topology.add_chain()
        for symbol in self.elements:
            element = mdtraj.element.Element.getBySymbol(symbol) if symbol != "X" else mdtraj.element.virtual
            topology.add_atom(symbol, element, topology.add_residue("LJ", chain))
        return mdtraj.Trajectory(
            xyz=(self.wrapped * sigma).astype(np.float32),
            topology=topology,
            time=self.time,
            unitcell_lengths=self.box * sigma,
            unitcell_angles=np.full((len(self), 3), 90.0),
        )

    def to_mdanalysis(self, *, sigma: float = 1.0) -> MDAnalysis.Universe:
        """An ``MDAnalysis.Universe`` with the frames in memory, lengths times ``sigma`` Å. Needs MDAnalysis.

        MDAnalysis holds single precision.
        """
        import MDAnalysis
        from MDAnalysis.coordinates.memory import MemoryReader

        n = self.positions.shape[1]
        universe = MDAnalysis.Universe.empty(n, trajectory=True, velocities=self.velocities is not None)
        universe.add_TopologyAttr("names", self.elements)
        universe.add_TopologyAttr("types", self.elements)
        angles = np.full((len(self), 3), 90.0)
        velocities = None if self.velocities is None else (self.velocities * sigma).astype(np.float32)
        spacing = float(self.time[1] - self.time[0]) if len(self) > 1 else 1.0
        universe.load_new(
            (self.wrapped * sigma).astype(np.float32),
            format=MemoryReader,
            order="fac",
            dimensions=np.hstack([self.box * sigma, angles]).astype(np.float32),
            velocities=velocities,
            dt=spacing,
            time_offset=float(self.time[0]) if len(self) else 0.0,
        )
        return universe
