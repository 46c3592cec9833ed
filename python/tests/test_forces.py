"""Forces without a scene: positions in, forces and energies out."""

from __future__ import annotations

import copy
import pickle

import lennard
import numpy as np
import pytest

SHIFT = {"kind": "shift", "r_cut": 2.5}


def liquid(n: int = 256, **tables: object) -> lennard.Simulation:
    """A melting crystal after some steps."""
    simulation = lennard.Simulation.liquid(density=0.8442, temperature=1.0, n=n, seed=3, **tables)
    simulation.step(100)
    return simulation


@pytest.mark.parametrize("truncation", ["shift", {"kind": "cut", "r_cut": 2.2}])
def test_forces_and_energy_are_those_of_a_simulation_in_the_same_place(truncation):
    table = {"kind": truncation} if isinstance(truncation, str) else truncation
    simulation = liquid(truncation=table)
    forces = lennard.Forces(simulation.box, truncation=truncation)
    found = forces.evaluate(simulation.positions)
    scale = np.abs(simulation.forces).max()
    assert np.abs(found.forces - simulation.forces).max() <= 1e-12 * scale
    assert found.energy / 256 == pytest.approx(simulation.potential_energy, rel=1e-12)
    assert found.virial is None and found.energies is None
    assert np.array_equal(forces(simulation.positions), found.forces)


def test_two_particles_have_the_textbook_force_and_energy():
    forces = lennard.Forces((9.0, 10.0, 11.0), "lennard-jones", truncation=SHIFT)
    found = forces.evaluate([[0.5, 0, 0], [8.0, 0, 0]], virial=True, energies=True)
    r = 1.5
    wanted = 24 * (2 * r**-13 - r**-7)
    assert found.forces == pytest.approx(np.array([[wanted, 0, 0], [-wanted, 0, 0]]), rel=1e-12)
    pair = 4 * (r**-12 - r**-6) - 4 * (2.5**-12 - 2.5**-6)
    assert found.energy == pytest.approx(pair, rel=1e-12)
    assert found.energies == pytest.approx([pair / 2, pair / 2], rel=1e-12)
    assert found.virial == pytest.approx(np.diag([r * wanted, 0, 0]), rel=1e-12)


def test_the_list_is_kept_between_calls_and_made_anew_where_particles_have_moved_far():
    simulation = liquid(864)
    positions = simulation.positions.copy()
    forces = lennard.Forces(simulation.box, truncation=SHIFT)
    rng = np.random.default_rng(0)
    for _ in range(20):
        positions += rng.normal(scale=1e-3, size=positions.shape)
        forces(positions)
    assert forces.builds == 1
    positions += rng.normal(scale=0.3, size=positions.shape)
    kept, fresh = forces(positions), lennard.Forces(simulation.box, truncation=SHIFT)(positions)
    assert forces.builds == 2
    assert np.abs(kept - fresh).max() <= 1e-11 * np.abs(fresh).max()


def test_a_changed_box_or_number_of_particles_is_seen():
    simulation = liquid()
    forces = lennard.Forces(simulation.box, truncation=SHIFT)
    forces(simulation.positions)
    for factor in (1.01, 1.05, 1.3):
        box, positions = simulation.box * factor, simulation.positions * factor
        fresh = lennard.Forces(box, truncation=SHIFT).evaluate(positions)
        assert forces.evaluate(positions, box).energy == pytest.approx(fresh.energy, rel=1e-12)
    assert forces(positions[:-1]).shape == (255, 3)


def test_other_potentials_precisions_and_copies():
    simulation = liquid()
    mie = lennard.potential.mie(repulsive=14)
    forces = lennard.Forces(simulation.box, mie, truncation=SHIFT, kernel={"precision": "mixed"}, threads=1)
    found = forces(simulation.positions)
    exact = lennard.Forces(simulation.box, mie, truncation=SHIFT)(simulation.positions)
    assert 0 < np.abs(found - exact).max() <= 1e-4 * np.abs(exact).max()
    for other in (copy.deepcopy(forces), pickle.loads(pickle.dumps(forces))):
        assert np.abs(other(simulation.positions) - found).max() <= 1e-5 * np.abs(exact).max()


def test_refusals_name_what_was_found_and_what_is_allowed():
    positions = liquid().positions
    with pytest.raises(ValueError, match=r"positions has the shape \(256, 2\)\n  allowed: \(N, 3\)"):
        lennard.Forces(6.7)(positions[:, :2])
    with pytest.raises(ValueError, match="box has the shape"):
        lennard.Forces([6.7, 6.7])
    with pytest.raises(lennard.SceneError) as refused:
        lennard.Forces(4.0)(positions)
    assert refused.value.key == "truncation.r_cut"
    with pytest.raises(lennard.SceneError) as refused:
        lennard.Forces(6.7, "lenard-jones")(positions)
    assert refused.value.nearest == "lennard-jones"
    wrong = positions.copy()
    wrong[7, 1] = np.nan
    with pytest.raises(ValueError, match="particle 7"):
        lennard.Forces(6.7)(wrong)
