"""The calculator for ASE, judged by finite differences and by ASE's own."""

from __future__ import annotations

import copy
import pickle

import lennard
import numpy as np
import pytest

ase = pytest.importorskip("ase")
from ase import Atoms, units  # noqa: E402
from ase.build import bulk  # noqa: E402
from ase.calculators.fd import calculate_numerical_forces  # noqa: E402
from ase.calculators.lj import LennardJones  # noqa: E402
from ase.constraints import FixAtoms  # noqa: E402
from ase.filters import FrechetCellFilter  # noqa: E402
from ase.md.langevin import Langevin  # noqa: E402
from ase.md.velocitydistribution import thermalize_momenta  # noqa: E402
from ase.md.verlet import VelocityVerlet  # noqa: E402
from ase.optimize import BFGS, FIRE, LBFGS  # noqa: E402
from lennard.ase import ARGON, Lennard  # noqa: E402


def fluid(seed: int = 0, n: int = 108, density: float = 0.7, sigma: float = 1.0, sides=(1.0, 1.0, 1.0)) -> Atoms:
    """Atoms at random without overlaps."""
    simulation = lennard.Simulation.liquid(
        density=density, temperature=1.0, n=n, start={"kind": "random"}, seed=seed, r_cut=1.5
    )
    scale = np.array(sides) * sigma
    return Atoms(f"Ar{n}", positions=simulation.positions * scale, cell=simulation.box * scale, pbc=True)


@pytest.mark.parametrize("seed", range(50))
def test_it_agrees_with_ase(seed):
    rng = np.random.default_rng(seed)
    sigma, epsilon = rng.uniform(0.8, 4.0), rng.uniform(0.01, 2.0)
    n = int(rng.integers(60, 200))
    atoms = fluid(seed, n, density=rng.uniform(0.4, 0.9), sigma=sigma, sides=rng.uniform(1.0, 1.15, 3))
    rc = float(min(2.5 * sigma, 0.49 * min(atoms.cell.lengths())))
    theirs = LennardJones(sigma=sigma, epsilon=epsilon, rc=rc)
    ours = Lennard(sigma=sigma, epsilon=epsilon, rc=rc, skin=0.0 if seed % 2 else None)
    for name in ("energy", "free_energy", "energies", "forces", "stress"):
        a, b = ours.get_property(name, atoms), theirs.get_property(name, atoms)
        assert np.abs(a - b).max() <= 1e-10 * np.abs(b).max(), name


TRUNCATIONS = ["shift", "force-shift", "switch"]


def test_xplor_is_the_smooth_cutoff_of_ase():
    atoms = fluid(9, 256, density=0.8)
    theirs = LennardJones(rc=2.5, ro=1.65, smooth=True)
    ours = Lennard(rc=2.5, truncation={"kind": "xplor", "switch_from": 1.65})
    # xplor is summed by rows, which hold U of a pair to 1e-10 and its force to 1e-9.
    for name, allowed in (("energy", 1e-10), ("forces", 1e-9), ("stress", 1e-8)):
        a, b = ours.get_property(name, atoms), theirs.get_property(name, atoms)
        assert np.abs(a - b).max() <= allowed * np.abs(b).max(), name


@pytest.mark.parametrize("truncation", TRUNCATIONS)
def test_forces_and_stress_hold_against_finite_differences(truncation):
    atoms = fluid(1, 108, sigma=3.4)
    atoms.calc = Lennard(sigma=3.4, epsilon=0.01, rc=7.5, truncation=truncation)
    numerical = calculate_numerical_forces(atoms, eps=1e-5, iatoms=range(6))
    assert np.abs(atoms.get_forces()[:6] - numerical).max() < 1e-7
    # The cell must stay a box, so that shear has ASE's own calculator as its judge.
    stress = atoms.get_stress()
    volume = atoms.get_volume()
    for axis in range(3):
        energies = []
        for sign in (1, -1):
            strained = atoms.copy()
            cell = strained.cell.array.copy()
            cell[axis, axis] *= 1 + sign * 1e-6
            strained.set_cell(cell, scale_atoms=True)
            strained.calc = atoms.calc
            energies.append(strained.get_potential_energy())
        assert stress[axis] == pytest.approx((energies[0] - energies[1]) / 2e-6 / volume, abs=1e-7)


def test_the_tail_belongs_to_energy_and_stress():
    atoms = fluid(2, 256)
    with_tail = Lennard(truncation="cut", tail=True, rc=2.5)
    without = Lennard(truncation="cut", rc=2.5)
    energy = [c.get_potential_energy(atoms) for c in (with_tail, without)]
    density = 256 / atoms.get_volume()
    tail = 8 / 9 * np.pi * density * (2.5**-9 - 3 * 2.5**-3)
    assert (energy[0] - energy[1]) / 256 == pytest.approx(tail, rel=1e-12)
    pressure = [-c.get_stress(atoms)[:3].sum() / 3 for c in (with_tail, without)]
    expected = 32 / 9 * np.pi * density**2 * (2.5**-9 - 1.5 * 2.5**-3)
    assert pressure[0] - pressure[1] == pytest.approx(expected, rel=1e-10)


def test_forces_are_the_engine_s(tmp_path, command_line):
    simulation = lennard.Simulation.liquid(density=0.7, temperature=1.0, n=256, truncation={"kind": "shift"})
    simulation.step(200)
    atoms = simulation.to_ase()
    atoms.calc = Lennard()
    forces = atoms.get_forces()
    assert np.abs(forces - simulation.forces).max() <= 1e-12 * np.abs(forces).max()
    assert atoms.get_potential_energy() / 256 == pytest.approx(simulation.potential_energy, rel=1e-12)
    kinetic = atoms.get_kinetic_energy() / 256
    assert kinetic == pytest.approx(simulation.kinetic_energy, rel=1e-12)
    pressure = -atoms.get_stress(include_ideal_gas=True)[:3].sum() / 3
    density = 256 / atoms.get_volume()
    # ASE counts 3N degrees of freedom in the ideal part and the engine 3N - 3, at half steps.
    ideal = density * (simulation.temperature - 2 / 3 * kinetic)
    half_steps = simulation.results().thermo["temperature_half_steps"][-1]
    shift = density * (half_steps - simulation.temperature)
    assert pressure + ideal + shift == pytest.approx(simulation.pressure, abs=1e-9)


def test_the_list_is_kept_between_calls():
    atoms = fluid(3, 256)
    atoms.calc = calc = Lennard()
    atoms.get_forces()
    rng = np.random.default_rng(0)
    for _ in range(20):
        atoms.positions += rng.normal(scale=1e-3, size=atoms.positions.shape)
        kept = atoms.get_forces()
        fresh = Lennard().get_property("forces", atoms)
        assert np.abs(kept - fresh).max() <= 1e-11 * np.abs(fresh).max()
    assert calc.list_builds == 1
    atoms.positions += rng.normal(scale=0.3, size=atoms.positions.shape)
    kept, fresh = atoms.get_forces(), Lennard().get_property("forces", atoms)
    assert np.abs(kept - fresh).max() <= 1e-11 * np.abs(fresh).max()
    assert calc.list_builds == 2


def test_the_compiled_part_counts_its_atoms():
    atoms = fluid(3, 256)
    atoms.calc = calc = Lennard()
    atoms.get_forces()
    sides = tuple(atoms.cell.lengths())
    with pytest.raises(ValueError, match="255 positions, made for 256"):
        calc._forces._evaluator.evaluate(atoms.positions[:-1], sides, True, True, False)


def test_a_changed_box_or_number_of_atoms_is_seen():
    atoms = fluid(4, 256)
    atoms.calc = Lennard()
    atoms.get_forces()
    for factor in (1.01, 1.05, 1.2):
        atoms.set_cell(atoms.cell * factor, scale_atoms=True)
        fresh = Lennard().get_property("energy", atoms)
        assert atoms.get_potential_energy() == pytest.approx(fresh, rel=1e-12)
    del atoms[3]
    assert atoms.get_potential_energy() == pytest.approx(Lennard().get_property("energy", atoms), rel=1e-12)
    atoms.calc.set(epsilon=2.0)
    twice = atoms.get_potential_energy()
    assert twice == pytest.approx(2 * Lennard().get_property("energy", atoms), rel=1e-12)


def test_what_it_cannot_do_is_refused_with_a_reason():
    atoms = fluid(5, 256)
    atoms.pbc = [True, True, False]
    with pytest.raises(ValueError, match="periodic along each axis"):
        Lennard().get_property("energy", atoms)
    atoms.pbc = True
    tilted = atoms.copy()
    tilted.cell[0, 1] = 0.5
    with pytest.raises(ValueError, match="a box along x, y and z"):
        Lennard().get_property("energy", tilted)
    for door in (Lennard().get_potential_energy, lambda none: lennard.ase.simulation(none, temperature=60)):
        with pytest.raises(ValueError, match="there are no atoms"):
            door(atoms[:0])
    mixed = atoms.copy()
    mixed.symbols[0] = "Kr"
    with pytest.raises(ValueError, match="found:   Ar, Kr"):
        Lennard().get_property("energy", mixed)
    # In Å, as it was given: a cell of an ASE user is often a unit cell.
    with pytest.raises(ValueError, match="rc = 9 Å, over half the shortest side"):
        Lennard(rc=9.0).get_property("energy", atoms)
    cell = bulk("Ar", "fcc", a=5.3, cubic=True)
    with pytest.raises(ValueError, match=r"found:   rc = 8.5125 Å.*\n.*rc up to 2.65 Å, or .*atoms.repeat\(4\)"):
        Lennard(**ARGON).get_property("energy", cell)
    repeated = Lennard(**ARGON).get_property("energy", cell.repeat(4))
    assert repeated / 256 == pytest.approx(-0.077, abs=0.001)
    with pytest.raises(ValueError, match="does not fit the cell"):
        lennard.ase.simulation(cell, **ARGON, temperature=60)
    Lennard(potential="wca").get_property("energy", fluid(5, 32, density=0.5))
    with pytest.raises(ValueError, match="`sigma` must be a finite positive number"):
        Lennard(sigma="3.4")
    with pytest.raises(ValueError, match="`epsilon` must be a finite positive number"):
        lennard.ase.simulation(atoms, epsilon=-1.0, temperature=60)
    held = atoms.copy()
    held.set_constraint(FixAtoms([0]))
    with pytest.raises(ValueError, match="found:   FixAtoms"):
        lennard.ase.simulation(held, temperature=60)
    with pytest.raises(ValueError, match="`smooth` of ase"):
        Lennard(smooth=True)
    with pytest.raises(TypeError, match="found:   sgma"):
        Lennard(sgma=1.0)
    with pytest.raises(ValueError, match="positive"):
        Lennard(sigma=-1.0)
    with pytest.raises(lennard.SceneError, match="truncation"):
        Lennard(truncation="shifted").get_property("energy", atoms)


@pytest.mark.parametrize("optimizer", [BFGS, FIRE, LBFGS])
@pytest.mark.parametrize("rattle, mask", [(0.0, None), (0.05, [1, 1, 1, 0, 0, 0])])
def test_a_crystal_and_its_cell_relax_to_the_end(optimizer, rattle, mask):
    atoms = bulk("Ar", "fcc", a=5.45, cubic=True) * (3, 3, 3)
    if rattle:
        atoms.rattle(rattle, seed=1)
    atoms.calc = Lennard(**ARGON, rc=7.4, truncation="force-shift")
    assert optimizer(FrechetCellFilter(atoms, mask=mask), logfile=None).run(fmax=1e-3, steps=200)
    sides = np.diagonal(atoms.cell.array)
    assert np.abs(atoms.cell.array - np.diag(sides)).max() < 1e-10 * sides.min()
    # The minimum of the perfect crystal, from its energy alone.
    energies = []
    lattice = np.linspace(5.31, 5.37, 7)
    for a in lattice:
        crystal = bulk("Ar", "fcc", a=a, cubic=True) * (3, 3, 3)
        energies.append(Lennard(**ARGON, rc=7.4, truncation="force-shift").get_property("energy", crystal))
    fit = np.polyfit(lattice - 5.34, energies, 4)
    minima = [5.34 + root.real for root in np.roots(np.polyder(fit)) if abs(root) < 0.03]
    assert sides / 3 == pytest.approx(minima[0], abs=0.003)


def test_rounding_across_the_axes_of_a_cell_is_none():
    atoms = fluid(5, 256)
    straight = Lennard().get_property("energy", atoms)
    sides = atoms.cell.lengths()
    for tilt, is_box in [(4.9e-14, True), (0.9e-10 * sides[0], True), (1.1e-10 * sides[0], False)]:
        tilted = atoms.copy()
        tilted.set_cell(atoms.cell.array + tilt * np.array([[0, 0, 0], [-1, 0, 0], [0, 1, 0]]), scale_atoms=True)
        if is_box:
            assert Lennard().get_property("energy", tilted) == pytest.approx(straight, rel=1e-12)
            assert lennard.ase.simulation(tilted, temperature=1 / units.kB).box == pytest.approx(sides, rel=1e-15)
        else:
            with pytest.raises(ValueError, match=r"to 1e-10 of a side\n.*mask=\[1, 1, 1, 0, 0, 0\]"):
                Lennard().get_property("energy", tilted)


def test_ase_drives_it():
    atoms = fluid(6, 108, sigma=ARGON["sigma"])
    atoms.calc = Lennard(**ARGON, rc=2.2 * ARGON["sigma"], truncation="force-shift")
    BFGS(atoms, logfile=None).run(fmax=0.02, steps=30)
    thermalize_momenta(atoms, temperature_K=90, rng=np.random.default_rng(1))
    start = atoms.get_total_energy()
    VelocityVerlet(atoms, timestep=4 * units.fs).run(100)
    assert abs(atoms.get_total_energy() - start) / 108 < 1e-5
    atoms.set_constraint(FixAtoms([0, 1]))
    held = atoms.positions[:2].copy()
    Langevin(
        atoms, timestep=4 * units.fs, temperature_K=90, friction=0.01, rng=np.random.default_rng(2)
    ).run(20)
    assert np.array_equal(atoms.positions[:2], held)


def test_copies_and_pickles_compute_the_same():
    atoms = fluid(7, 108)
    atoms.calc = Lennard(rc=2.0)
    energy = atoms.get_potential_energy()
    for other in (copy.deepcopy(atoms.calc), pickle.loads(pickle.dumps(atoms.calc))):
        assert other.get_property("energy", atoms) == energy
    calc = atoms.calc
    atoms.calc = None
    assert calc.get_property("energy", atoms) == energy


def test_a_mixture_keeps_its_elements_and_masses():
    kinds = [{"name": "Ar", "fraction": 0.5}, {"name": "Kr", "fraction": 0.5, "mass": 2.0}]
    simulation = lennard.Simulation.liquid(
        density=0.6, temperature=1.2, n=256, r_cut=2.5, species=kinds, mixing={"rule": "lorentz-berthelot"}
    )
    atoms = simulation.to_ase(**ARGON, mass=39.948)
    symbols = np.array(atoms.get_chemical_symbols())
    assert sorted(set(symbols)) == ["Ar", "Kr"] and simulation.elements == list(symbols)
    assert np.array_equal(atoms.get_masses(), 39.948 * np.where(symbols == "Kr", 2.0, 1.0))
    # ASE divides by 3N, and the engine by what the total momentum leaves.
    kelvin = simulation.temperature * (1 - 1 / 256) * ARGON["epsilon"] / units.kB
    assert atoms.get_temperature() == pytest.approx(kelvin, rel=1e-9)
    frames = simulation.frames(every=5, n=2)
    assert frames.to_ase()[0].get_chemical_symbols() == list(symbols)
    found = [atom.element.symbol for atom in frames.to_mdtraj().topology.atoms]
    assert found == list(symbols)
    assert list(frames.to_mdanalysis().atoms.types) == list(symbols)


def test_a_simulation_takes_atoms_and_gives_them_back():
    atoms = fluid(8, 256, sigma=ARGON["sigma"], density=0.8)
    thermalize_momenta(atoms, temperature_K=100, rng=np.random.default_rng(3))
    atoms.set_momenta(atoms.get_momenta() - atoms.get_momenta().mean(axis=0))
    mass = atoms.get_masses()[0]
    simulation = lennard.ase.simulation(atoms, **ARGON, dt=2 * units.fs)
    by_ase = atoms.copy()
    by_ase.set_momenta(atoms.get_momenta())
    by_ase.calc = Lennard(**ARGON)
    VelocityVerlet(by_ase, timestep=2 * units.fs).run(50)
    simulation.step(50)
    back = simulation.to_ase(**ARGON, mass=mass)
    assert np.abs(back.positions - by_ase.positions).max() < 1e-9
    assert back.get_temperature() == pytest.approx(by_ase.get_temperature(), rel=1e-9)
    with pytest.raises(ValueError, match="no momenta"):
        lennard.ase.simulation(fluid(8))
    drawn = lennard.ase.simulation(fluid(8, 256), temperature=1.0 / units.kB, rc=2.5)
    assert drawn.temperature == pytest.approx(1.0, abs=1e-12)
