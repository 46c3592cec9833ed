"""The list of seeded faults does not rot: each text is where the list says, once."""

from __future__ import annotations

import pytest

import seeded_faults


def test_each_fault_changes_one_place_of_a_source_that_is_there():
    faults = seeded_faults.faults()
    assert len(faults) >= 40
    for fault in faults:
        text = (seeded_faults.ROOT / fault["file"]).read_text(encoding="utf-8")
        assert seeded_faults.seeded(text, fault) != text
        assert fault["test"].startswith("--package lennard-")


def test_a_text_that_is_gone_is_an_error():
    fault = {**seeded_faults.faults()[0], "text": "no such text"}
    with pytest.raises(ValueError, match="0 times; wanted: once"):
        seeded_faults.seeded("", fault)
