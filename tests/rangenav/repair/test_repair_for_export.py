"""Repair for an export: what is accepted can be written and certified; where nothing is found, the way out is named."""

import msgspec
import numpy as np
import pytest

from rangenav import preset, repair
from rangenav.certificate import certified_export
from rangenav.formats import ExportOptions
from tests.support.present import present

pytestmark = pytest.mark.slow

EIGHT = preset.load("figure-eight")
LOOP = repair.ExportTarget(format_name="polynomial")
replace = msgspec.structs.replace


def test_what_a_repair_for_an_export_accepts_is_exported_as_a_loop_of_the_same_period():
    repaired = repair.repair(EIGHT, target=LOOP)
    assert repaired.after.vehicle == EIGHT.vehicle
    assert certified_export.refusal(repaired.after, "polynomial", ExportOptions()) is None
    assert present(repaired.after.path.period) == pytest.approx(present(EIGHT.path.period))


def test_a_motion_that_meets_its_requirement_and_cannot_be_exported_is_changed_until_it_can():
    """The hand-held preset is observable, but flying its path asks more turning than its vehicle allows."""
    waved = preset.load("hand-held")
    assert repair.repair(waved).after.path == waved.path
    slower = repair.repair(waved, by="timescale", target=LOOP)
    assert slower.after.path != waved.path
    assert certified_export.refusal(slower.after, "polynomial", ExportOptions()) is None


def test_where_nothing_is_found_the_reason_names_a_window_that_would_do_or_the_anchor():
    short = preset.with_window(EIGHT, 4.0, source="x")
    with pytest.raises(repair.CannotRepairError, match=r"; try a longer window, or move the anchor") as refused:
        repair.repair(short, evaluations=40)
    assert "would do" in str(refused.value)
    at_the_path = replace(EIGHT, world=replace(EIGHT.world, anchor=tuple(EIGHT.path(np.zeros(())).tolist())))
    with pytest.raises(repair.CannotRepairError, match="move the anchor"):
        repair.repair(at_the_path)
