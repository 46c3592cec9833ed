"""Arrays that are no arrays of real numbers are refused by name, at each door."""

from __future__ import annotations

import lennard
import numpy as np
import pytest

PLACES = np.array([[1.0, 1.0, 1.0], [3.0, 3.0, 3.0], [5.0, 5.0, 5.0]])
MASKED = np.ma.masked_greater(PLACES, 4.0)


def ring() -> dict[str, object]:
    """A dictionary that holds itself."""
    table: dict[str, object] = {"density": 0.8, "kind": "x"}
    table["itself"] = table
    return table


def start(positions=PLACES, box=8.0, velocities=None) -> lennard.Simulation:
    return lennard.Simulation.from_arrays(positions, box, velocities, temperature=1.0)


NO_VECTORS = [
    ([], r"the shape \(0,\)"),
    (np.zeros((0, 3)), r"the shape \(0, 3\)"),
    (np.arange(9.0), r"the shape \(9,\)"),
    (PLACES[:, :2], r"the shape \(3, 2\)"),
    (PLACES.reshape(3, 3, 1), r"the shape \(3, 3, 1\)"),
    (5.0, r"the shape \(\)"),
    (MASKED, "real numbers\n  found:   3 masked of 9 entries"),
    (PLACES + 1j, "real numbers\n  found:   entries of the type complex128"),
    (PLACES.astype(str), "real numbers\n  found:   entries of the type <U"),
    (PLACES > 2.0, "real numbers\n  found:   entries of the type bool"),
    ([[1.0, 2.0], [3.0]], "real numbers\n  found:   lists of unequal lengths"),
    (ring(), "real numbers\n  found:   entries of the type object"),
    (None, "real numbers\n  found:   entries of the type object"),
]


@pytest.mark.parametrize("given, words", NO_VECTORS)
def test_positions_and_velocities_are_vectors(given, words):
    with pytest.raises(ValueError, match=f"positions (has|must be) {words}") as caught:
        start(positions=given)
    assert "allowed: " in str(caught.value)
    if given is not None:
        with pytest.raises(ValueError, match=f"velocities (has|must be) {words}"):
            start(velocities=given)


def test_a_list_that_holds_itself_is_no_array():
    endless: list[object] = []
    endless.append(endless)
    with pytest.raises(ValueError, match="positions"):
        start(positions=endless)


def test_numbers_of_any_kind_and_masks_that_mask_nothing_are_taken():
    whole = start(positions=PLACES.astype(int), box=np.float32(8.0))
    assert np.array_equal(whole.positions, PLACES)
    assert np.array_equal(start(positions=np.ma.array(PLACES)).positions, PLACES)
    assert np.array_equal(start(positions=PLACES.tolist(), box=[8, 8, 8]).positions, PLACES)


@pytest.mark.parametrize("box", [[], [8.0, 8.0], 8.0 + 0j, np.ma.array([8.0] * 3, mask=[0, 1, 0]), "8", None])
def test_a_box_is_one_or_three_real_numbers(box):
    with pytest.raises(ValueError, match="^box (has|must be)"):
        start(box=box)


def test_what_is_not_finite_and_what_is_missing_is_named():
    wrong = PLACES.copy()
    wrong[1, 2] = np.inf
    with pytest.raises(ValueError, match="positions hold what is not a finite number\n  found:   particle 1,"):
        start(positions=wrong)
    with pytest.raises(ValueError, match="velocities hold what is not a finite number\n  found:   particle 1,"):
        start(velocities=wrong)
    with pytest.raises(ValueError, match=r"velocities has the shape \(2, 3\)\n  allowed: \(3, 3\)"):
        start(velocities=PLACES[:2])


@pytest.mark.parametrize("name", ["density", "temperature"])
@pytest.mark.parametrize(
    "wrong", [0.5 + 0j, np.ma.masked_greater([0.5, 0.9], 0.7), np.array([0.5 + 1j]), "0.5", [[0.5], [0.5, 0.6]], None]
)
def test_equations_of_state_take_real_numbers(name, wrong):
    given = {"density": 0.5, "temperature": 1.5, name: wrong}
    with pytest.raises(ValueError, match=f"^{name} must be"):
        lennard.eos.thol_2016.pressure(**given)
    with pytest.raises(ValueError, match=f"^{name} must be"):
        lennard.eos.thol_2016.at(**given)
    with pytest.raises(ValueError, match="^temperature must be"):
        lennard.eos.thol_2016.coexistence(wrong)


def test_shapes_of_states_go_together():
    thol = lennard.eos.thol_2016
    assert thol.pressure(np.array([]), 1.5).shape == (0,)
    assert thol.pressure([0.3, 0.5], np.array([[1.5], [2.0]])).shape == (2, 2)
    with pytest.raises(ValueError, match=r"differ in shape\n  found:   \(2,\) and \(3,\)"):
        thol.pressure(np.ones(2), np.ones(3))
    with pytest.raises(ValueError, match=r"density has the shape \(1,\)"):
        thol.at([0.5], 1.5)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: lennard.Simulation({"system": ring()}), r"`system\.itself\.itself.*` holds itself"),
        (lambda: lennard.Simulation("fluid/gas", set={"system": ring()}), "`system.itself.*` holds itself"),
        (lambda: lennard.Simulation("fluid/gas", stage=[ring()]), "`stage.0.itself.*` holds itself"),
        (lambda: lennard.Simulation("fluid/gas", set={"system.box": MASKED[2]}), "`system.box` must be real numbers"),
        (lambda: lennard.Simulation("fluid/gas", set={"system.box": PLACES[0] + 1j}), "`system.box` must be real"),
        (lambda: lennard.sweep("fluid/gas", {"temperature": MASKED[2]}), "`system.temperature` must be real numbers"),
    ],
)
def test_a_scene_takes_no_masks_no_complex_numbers_and_nothing_endless(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_a_grid_needs_lists_and_a_point_keys():
    with pytest.raises(TypeError, match=r"a point of a sweep is a dictionary\n  found:   array\(\[1., 2.\]\)"):
        lennard.sweep("fluid/gas", points=np.array([[1.0, 2.0]]))
    with pytest.raises(ValueError, match="at least one point"):
        lennard.sweep("fluid/gas", {"temperature": np.array([])})
    with pytest.raises(TypeError, match="`temperature` of a grid needs a list"):
        lennard.sweep("fluid/gas", {"temperature": np.array(1.5)})
    with pytest.raises(TypeError, match="found: complex128 at `system.temperature`"):
        lennard.sweep("fluid/gas", {"temperature": np.array([1.5 + 0j])})
