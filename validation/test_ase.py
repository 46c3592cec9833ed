"""Our files and our forces, judged by ase."""

from __future__ import annotations

from numbers import Integral

import ase.io
import numpy as np
import pytest
from ase.calculators.lj import LennardJones

import lennard_validation as lv
from conftest import Scene

#: Numbers in the files are the shortest text that reads back to the same bits. Two errors are left: a few
#: roundings of numbers of order ten, and the folding of positions into the box.
EXACT = 2e-14


def boxes(frames) -> np.ndarray:
    return np.array([frame.cell.lengths() for frame in frames])


def unwrapped(frame) -> np.ndarray:
    return frame.positions + frame.arrays["map_shift"] * frame.cell.lengths()


def test_every_frame_is_there_with_its_step_and_time(every_step):
    frames = lv.load_frames(every_step.folder)
    steps = [frame.info["Step"] for frame in frames]
    assert steps == list(range(801, 841))
    assert all(isinstance(step, Integral) for step in steps)
    times = np.array([frame.info["Time"] for frame in frames])
    np.testing.assert_allclose(times, np.array(steps) * 0.004, rtol=1e-13)
    assert every_step.record["trajectory_frames"] == len(frames)


def test_box_is_the_scenes_and_periodic(every_step):
    frames = lv.load_frames(every_step.folder)
    np.testing.assert_array_equal(boxes(frames), np.tile([6.8, 8.5, 8.25], (len(frames), 1)))
    assert all(frame.pbc.all() for frame in frames)
    assert all((frame.cell.angles() == 90.0).all() for frame in frames)


def test_particles_are_argon_inside_the_box(every_step):
    for frame in lv.load_frames(every_step.folder):
        assert frame.get_chemical_formula() == "Ar400"
        assert (frame.positions >= 0.0).all()
        assert (frame.positions < frame.cell.lengths()).all()


def test_last_frame_is_the_final_state(every_step):
    last = lv.load_frames(every_step.folder)[-1]
    final = ase.io.read(every_step.folder / "final.xyz", format="extxyz")
    assert final.info["Step"] == last.info["Step"]
    np.testing.assert_array_equal(final.positions, last.positions)
    np.testing.assert_array_equal(final.arrays["velo"], last.arrays["velo"])


def verlet_residuals(frames, dt: float) -> np.ndarray:
    """How far each frame is from the velocity-Verlet step out of the frame before.

    Entries are the largest difference of a position and of a velocity, [frames - 1, 2].
    """
    residuals = []
    for now, after in zip(frames, frames[1:], strict=False):
        moved = dt * now.arrays["velo"] + 0.5 * dt**2 * now.get_forces()
        kicked = 0.5 * dt * (now.get_forces() + after.get_forces())
        residuals.append(
            [
                np.abs(unwrapped(after) - unwrapped(now) - moved).max(),
                np.abs(after.arrays["velo"] - now.arrays["velo"] - kicked).max(),
            ]
        )
    return np.array(residuals)


def test_consecutive_frames_are_steps_of_velocity_verlet(every_step):
    """Positions, image flags, velocities, forces and time belong to the same states: with x, v, F of
    one frame the next one follows."""
    frames = lv.load_frames(every_step.folder)
    assert (verlet_residuals(frames, 0.004) < EXACT).all()
    assert any((frame.arrays["map_shift"] != 0).any() for frame in frames), "no particle crossed a face"


def test_a_wrong_velocity_image_force_or_frame_would_be_seen(every_step):
    def broken(change) -> np.ndarray:
        frames = lv.load_frames(every_step.folder)
        change(frames)
        return verlet_residuals(frames, 0.004).max(axis=0)

    def velocity_of_another_time(frames):
        frames[5].arrays["velo"] += 0.5 * 0.004 * frames[5].get_forces()

    def lost_image(frames):
        frames[5].arrays["map_shift"][7, 2] += 1

    def other_force(frames):
        frames[5].calc.results["forces"] = frames[6].get_forces()

    def missing_frame(frames):
        del frames[5]

    assert (broken(velocity_of_another_time) > 1e-5).all()
    assert broken(lost_image)[0] > 1.0
    assert (broken(other_force) > 1e-9).all()
    assert (broken(missing_frame) > 1e-5).all()
    with pytest.raises(AssertionError):
        assert (verlet_residuals(lv.load_frames(every_step.folder), 0.0040001) < EXACT).all()


def test_energies_of_the_header_are_those_of_the_frame(every_step):
    """Kinetic energy and temperature from the velocities of the same frame, potential energy and
    forces from ase's calculator. Its shift at rc makes it the truncated-shifted potential."""
    dt = every_step.scene["integrator"]["dt"]
    for frame in lv.load_frames(every_step.folder)[::8]:
        kinetic = 0.5 * (frame.arrays["velo"] ** 2).sum()
        n = len(frame)
        assert frame.info["total_kinetic_energy"] == pytest.approx(kinetic, rel=1e-13)
        assert frame.info["temperature"] == pytest.approx(2.0 * kinetic / (3 * n - 3), rel=1e-13)
        judged = frame.copy()
        judged.calc = LennardJones(sigma=1.0, epsilon=1.0, rc=2.5, smooth=False)
        # 20,000 pair terms of order one in two orders of summation.
        assert frame.info["total_potential_energy"] == pytest.approx(judged.get_potential_energy(), rel=1e-12)
        virial = -3.0 * judged.get_volume() * judged.get_stress()[:3].mean()
        # The mean of the kinetic energies half a step earlier and later, v -+ dt/2 F.
        forces = frame.get_forces()
        half_steps = sum((0.5 * (frame.arrays["velo"] + sign * 0.5 * dt * forces) ** 2).sum() for sign in (1, -1)) / 2
        temperature = 2.0 * half_steps / (3 * n - 3)
        assert frame.info["temperature_half_steps"] == pytest.approx(temperature, rel=1e-13)
        assert temperature > frame.info["temperature"]
        pressure = n / judged.get_volume() * temperature - judged.get_stress()[:3].mean()
        assert abs(virial) > 1.0
        assert frame.info["pressure"] == pytest.approx(pressure, rel=1e-11)
        assert np.abs(frame.get_forces() - judged.get_forces()).max() < 1e-11


@pytest.mark.parametrize("kernel", ["auto", "reference"])
@pytest.mark.parametrize("mode", ["auto", "direct"])
def test_one_evaluation_agrees_with_ases_calculator(every_step, tmp_path, kernel, mode):
    """Energy, virial and forces of a liquid in a box with three sides, by `lennard energy`."""
    scene = Scene(configuration=every_step.folder / "final.xyz", truncation='kind = "shift"\nr_cut = 3.3')
    path = tmp_path / "forces.xyz"
    ours = lv.energy(
        scene.write(tmp_path),
        settings={"kernel.kernel": kernel, "neighbor.mode": mode},
        forces=path,
    )
    written = ase.io.read(path, format="extxyz")
    judged = ase.io.read(every_step.folder / "final.xyz", format="extxyz")
    judged.calc = LennardJones(sigma=1.0, epsilon=1.0, rc=3.3, smooth=False)
    assert ours["potential_energy"] == pytest.approx(judged.get_potential_energy(), rel=1e-12)
    virial = -3.0 * judged.get_volume() * judged.get_stress()[:3].mean()
    # ase's stress has no kinetic part; W is a difference of terms a hundred times larger.
    assert ours["virial"] == pytest.approx(virial, rel=1e-10)
    assert ours["tail_energy"] == ours["tail_virial"] == 0.0
    # Forces of up to a few hundred, summed over a hundred pairs.
    assert np.abs(written.get_forces() - judged.get_forces()).max() < 1e-11


def test_the_switch_of_xplor_is_ases_smooth_cutoff(every_step, tmp_path):
    """The same switch between 1.98 and 3 sigma: energy, virial and forces."""
    scene = Scene(
        configuration=every_step.folder / "final.xyz", truncation='kind = "xplor"\nr_cut = 3.0\nswitch_from = 1.98'
    )
    path = tmp_path / "forces.xyz"
    ours = lv.energy(scene.write(tmp_path), forces=path)
    written = ase.io.read(path, format="extxyz")
    judged = ase.io.read(every_step.folder / "final.xyz", format="extxyz")
    judged.calc = LennardJones(sigma=1.0, epsilon=1.0, rc=3.0, ro=1.98, smooth=True)
    assert ours["potential_energy"] == pytest.approx(judged.get_potential_energy(), rel=1e-10)
    virial = -3.0 * judged.get_volume() * judged.get_stress()[:3].mean()
    # Rows hold the force of a pair to 1e-9; some of these pairs have forces of a hundred.
    assert ours["virial"] == pytest.approx(virial, rel=1e-8)
    assert np.abs(written.get_forces() - judged.get_forces()).max() < 1e-7
    judged.calc = LennardJones(sigma=1.0, epsilon=1.0, rc=3.0, ro=2.0, smooth=True)
    assert abs(ours["potential_energy"] - judged.get_potential_energy()) > 0.1, "the switch is seen"


def test_plain_cutoff_differs_from_the_shifted_one_by_the_shift_of_each_pair(every_step, tmp_path):
    """Plain cut U = shifted U + pairs * U(r_cut): the pairs are counted by ase."""
    from ase.neighborlist import neighbor_list

    r_cut = 2.5
    scene = Scene(configuration=every_step.folder / "final.xyz")
    ours = lv.energy(scene.write(tmp_path))
    judged = ase.io.read(every_step.folder / "final.xyz", format="extxyz")
    pairs = len(neighbor_list("i", judged, r_cut)) // 2
    assert ours["pairs"] == pairs
    judged.calc = LennardJones(sigma=1.0, epsilon=1.0, rc=r_cut, smooth=False)
    u_cut = 4.0 * (r_cut**-12 - r_cut**-6)
    expected = judged.get_potential_energy() + pairs * u_cut
    assert ours["potential_energy"] == pytest.approx(expected, rel=1e-12)
    # The tail integrals of a homogeneous fluid (Allen and Tildesley, eqs. 2.139 and 2.141).
    n, volume = len(judged), judged.get_volume()
    tail_energy = 8.0 / 3.0 * np.pi * n**2 / volume * (r_cut**-9 / 3.0 - r_cut**-3)
    tail_virial = 16.0 * np.pi * n**2 / volume * (2.0 / 3.0 * r_cut**-9 - r_cut**-3)
    assert ours["tail_energy"] == pytest.approx(tail_energy, rel=1e-13)
    assert ours["tail_virial"] == pytest.approx(tail_virial, rel=1e-13)
