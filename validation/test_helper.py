"""The helpers refuse what they must: each test breaks one thing."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

import lennard_validation as lv


@pytest.fixture
def copy(every_step, tmp_path):
    """A copy of a good run's folder, to be broken."""
    folder = tmp_path / "run"
    shutil.copytree(every_step.folder, folder)
    return folder


def edit(path, change) -> None:
    before = path.read_text(encoding="utf-8")
    after = change(before)
    assert after != before, "nothing was broken"
    path.write_text(after, encoding="utf-8")


def test_an_unbroken_copy_is_accepted(copy):
    assert lv.load_trajectory(copy).n_frames == len(lv.load_frames(copy)) == 40


LINES_A_FRAME = 400 + 2

BREAKAGES = {
    "last frame missing": lambda text: "".join(text.splitlines(True)[:-LINES_A_FRAME]),
    "first frame missing": lambda text: "".join(text.splitlines(True)[LINES_A_FRAME:]),
    "last row missing": lambda text: "".join(text.splitlines(True)[:-1]),
    "last row cut short": lambda text: text[:-9],
    "a row in the middle missing": lambda text: "".join(
        line for i, line in enumerate(text.splitlines(True)) if i != 5 * LINES_A_FRAME + 7
    ),
    "another step in a header": lambda text: text.replace("Step=810 ", "Step=811 ").replace(
        "Step=810\n", "Step=811\n"
    ),
    "a number missing in a row": lambda text: text[: text.rstrip().rfind(" ")] + "\n",
    "another count": lambda text: text.replace("400\n", "399\n", 1),
}


@pytest.mark.parametrize("how", BREAKAGES)
@pytest.mark.parametrize("load", [lv.load_frames, lv.load_trajectory], ids=["ase", "mdtraj"])
def test_a_broken_trajectory_is_refused(copy, how, load):
    edit(copy / "trajectory.xyz", BREAKAGES[how])
    with pytest.raises(lv.BadTrajectory):
        load(copy)


def test_mdtraj_alone_would_not_have_noticed(copy):
    """Why the frames are counted: mdtraj drops a truncated last frame without a word."""
    import mdtraj

    edit(copy / "trajectory.xyz", BREAKAGES["last row missing"])
    bare = mdtraj.load_xyz(str(copy / "trajectory.xyz"), top=str(copy / "topology.gro"))
    assert bare.n_frames == 39
    assert bare.unitcell_lengths is None


def test_an_unfinished_run_is_refused(copy):
    record = json.loads((copy / "run.json").read_text(encoding="utf-8"))
    record["finished"] = False
    (copy / "run.json").write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(ValueError, match="did not finish"):
        lv.load_frames(copy)


def test_a_run_without_trajectory_is_told(copy):
    edit(copy / "scene.toml", lambda text: text.replace("trajectory_every = 1\n", "trajectory_every = 0\n"))
    with pytest.raises(lv.BadTrajectory, match="asks for no trajectory"):
        lv.load_trajectory(copy)


def test_bad_input_raises_with_exit_code_2(tmp_path):
    scene = tmp_path / "bad.toml"
    scene.write_text("[system]\nn_atoms = -3\n", encoding="utf-8")
    with pytest.raises(lv.CommandFailed) as caught:
        lv.run(scene, out=tmp_path / "run")
    assert caught.value.code == 2
    assert not (tmp_path / "run").exists()


def test_blocked_error_is_that_of_a_correlated_series():
    """An autoregressive series with correlation time 20: the error of its mean is known."""
    rng = np.random.default_rng(5)
    a, n = np.exp(-1.0 / 20.0), 200_000
    noise = rng.normal(size=n)
    series = np.empty(n)
    series[0] = noise[0] / np.sqrt(1 - a * a)
    for i in range(1, n):
        series[i] = a * series[i - 1] + noise[i]
    exact = 1.0 / ((1.0 - a) * np.sqrt(n))
    found = lv.blocked_error(series)
    # 25 blocks leave 14 % of uncertainty; three of these.
    assert found.standard_error == pytest.approx(exact, rel=0.42)
    naive = series.std() / np.sqrt(n)
    assert naive < 0.2 * exact
    with pytest.raises(ValueError, match="too few"):
        lv.blocked_error(series[:30])


def test_errors_that_are_too_small_or_too_large_are_seen():
    rng = np.random.default_rng(7)
    means = rng.normal(scale=0.01, size=10)
    probability = lambda factor: lv.chi_squared_of_spread(means, np.full(10, 0.01 * factor))[1]
    assert 0.001 < probability(1.0) < 0.999
    assert probability(0.3) > 0.999
    assert probability(4.0) < 0.001
