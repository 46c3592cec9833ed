"""The JSON Schema of scenes, judged by the jsonschema package."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

INPUTS = Path(__file__).parent.parent / "inputs"
SCHEMA = json.loads((INPUTS / "scene.schema.json").read_text())


def scenes() -> list[Path]:
    """Every scene that runs: neither a sweep, nor a lock file, nor a scene that is refused."""
    found = []
    for path in sorted(INPUTS.rglob("*.toml")):
        is_sweep = any(line.startswith("base = ") for line in path.read_text().splitlines())
        if path.name != "bad.toml" and not path.name.endswith(".lock.toml") and not is_sweep:
            found.append(path)
    return found


def validator() -> jsonschema.Draft7Validator:
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    return jsonschema.Draft7Validator(SCHEMA)


def test_every_scene_is_valid():
    assert len(scenes()) > 30
    for path in scenes():
        faults = [f"{e.json_path}: {e.message}" for e in validator().iter_errors(tomllib.loads(path.read_text()))]
        assert not faults, (path, faults)


@pytest.mark.parametrize(
    "table, key, value, path",
    [
        ("system", "n_atom", 256, "$.system"),
        ("truncation", "r_cut", 1e-300, "$.truncation.r_cut"),
        ("system", "n_atoms", 256.5, "$.system.n_atoms"),
    ],
)
def test_mistakes_are_found(table: str, key: str, value: float, path: str):
    scene = tomllib.loads((INPUTS / "fluid" / "gas.toml").read_text())
    scene.setdefault(table, {})[key] = value
    faults = {e.json_path for e in validator().iter_errors(scene)}
    assert path in faults, faults
