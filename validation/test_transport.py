"""Our mean-square displacement and structure factor, judged by freud, and our Green-Kubo integral by numpy."""

from __future__ import annotations

import freud
import numpy as np
import pytest
from conftest import Scene

import lennard_validation as lv

#: Steps between two frames, and between two looks at the displacement.
EVERY = 10

#: Frames from one look at the structure factor to the next: freud takes seconds for each ten, and neighboring frames
#: say the same.
FRAMES_A_LOOK = 4

#: Steps between two looks at the pressure tensor, both for its series and for the viscosity.
STRESS_EVERY = 5

OBSERVABLES = f"""
[[observable]]
kind = "msd"
every = {EVERY}
longest_lag = 4.0

[[observable]]
kind = "structure-factor"
every = {EVERY * FRAMES_A_LOOK}
k_max = 12.0
shells = 40
directions = 200

[[observable]]
kind = "pressure-tensor"
every = {STRESS_EVERY}

[[observable]]
kind = "shear-viscosity"
every = {STRESS_EVERY}
window = 4.0
"""


@pytest.fixture(scope="module")
def liquid(tmp_path_factory) -> lv.Run:
    """A liquid of 500 particles with 400 frames."""
    scene = Scene(
        density=0.8,
        temperature=1.0,
        n_atoms=500,
        equilibrate=2000,
        steps=4000,
        observables=OBSERVABLES,
        output=f"trajectory_every = {EVERY}\nunwrapped = true",
    )
    return scene.run(tmp_path_factory.mktemp("transport"))


@pytest.fixture(scope="module")
def frames(liquid):
    return lv.load_frames(liquid.folder)


def test_mean_square_displacement_is_freuds(liquid, frames):
    positions = np.array([frame.positions for frame in frames])
    theirs = freud.msd.MSD(mode="window").compute(positions).msd
    table = {name: np.array(column) for name, column in liquid.table("msd").items()}
    interval = EVERY * liquid.scene["integrator"]["dt"]
    compared = 0
    for time, ours, error in zip(table["time"], table["msd"], table["standard_error"], strict=True):
        lag = round(time / interval)
        if not 0 < lag < 80 or abs(lag * interval - time) > 1e-9 or not np.isfinite(error):
            continue
        # Both average over the same particles, ours over a part of the time origins.
        assert abs(ours - theirs[lag]) < 5.0 * error + 1e-6, (lag, ours, theirs[lag], error)
        compared += 1
    assert compared >= 10


def test_structure_factor_is_freuds(liquid, frames):
    table = {name: np.array(column) for name, column in liquid.table("structure_factor").items()}
    width = 12.0 / 40
    direct = freud.diffraction.StaticStructureFactorDirect(bins=40, k_max=12.0, k_min=0.0)
    side = float(frames[0].cell.lengths()[0])
    box = freud.box.Box.cube(side)
    looked_at = [frame for frame in frames if frame.info["Step"] % (EVERY * FRAMES_A_LOOK) == 0]
    for number, frame in enumerate(looked_at):
        direct.compute((box, box.wrap(frame.positions)), reset=number == 0)
    theirs = np.array(direct.S_k)
    compared = 0
    for k, ours, error in zip(table["k"], table["structure_factor"], table["standard_error"], strict=True):
        shell = int(k / width)
        if not (0 < shell < 39 and np.isfinite(error) and np.isfinite(theirs[shell - 1 : shell + 2]).all()):
            continue
        # freud takes every wave vector of the shell, and Lennard takes up to 200. Where S(k) rises, the means
        # of k differ by up to a tenth of the shell.
        slope = 0.1 * np.abs(np.diff(theirs[shell - 1 : shell + 2])).max()
        assert abs(ours - theirs[shell]) < 5.0 * error + slope + 0.01, (k, ours, theirs[shell], error)
        compared += 1
    assert compared >= 20


def test_stress_correlation_and_viscosity_are_those_of_the_series(liquid):
    p = {name: np.array(column) for name, column in liquid.table("pressure_tensor").items()}
    xx, yy, zz = (p[name] for name in ("xx", "yy", "zz"))
    components = [p["xy"], p["xz"], p["yz"], (xx - yy) / 2, (2 * zz - xx - yy) / (2 * np.sqrt(3))]
    volume = liquid.record["atoms"] / 0.8
    temperature = liquid.averages["temperature"]["mean"]
    ours = {name: np.array(column) for name, column in liquid.table("shear_viscosity").items()}
    interval = STRESS_EVERY * liquid.scene["integrator"]["dt"]
    # The first sixteen lags are plain products of samples. The mean temperature comes from other samples, for
    # some averages after a cut: it may be off by 2 %.
    for lag in range(16):
        exact = volume / temperature * np.mean([np.mean(c[: len(c) - lag] * c[lag:]) for c in components])
        assert abs(ours["time"][lag] - lag * interval) < 1e-9
        assert ours["correlation"][lag] == pytest.approx(exact, rel=0.02), lag
    # The Green-Kubo integral over those lags, by the trapezoidal rule.
    correlation = ours["correlation"][:16]
    integral = interval * (correlation.sum() - 0.5 * (correlation[0] + correlation[-1]))
    assert ours["integral"][15] == pytest.approx(integral, rel=1e-9)
