"""Grippers: chosen by their kind, and checked on what they are given."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.grip import GripLoad
from pack_core.robots.kr210 import add_kr210
from pack_core.robots.surface_gripper import PAD_BIT, TOOL, gripper_tool

FACTS = {
    "kind": "square_pad", "length": 0.25, "mass": 12.0, "mast_radius": 0.045, "plate_radius": 0.1,
    "pad_size": 0.11,
}  # fmt: skip


def test_the_kind_decides_which_gripper_it_is() -> None:
    assert gripper_tool(FACTS, "here") == palletizing_cell().tool


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "magnets"}, "here: key 'kind' is 'magnets'; allowed: .*square_pad"),
        ({"kind": None}, "here: key 'kind' is None; allowed: .*square_pad"),
        ({"zones": 2}, "here: key 'zones' is not known"),
        ({"pad_size": 0.08}, "mast_radius is 0.045 m and pad_size 0.08 m; allowed: a mast that is no wider"),
    ],
)
def test_facts_that_do_not_fit_are_named(change: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        gripper_tool({**FACTS, **change}, "here")


def test_the_body_has_its_mass_and_its_pad_faces_out_at_its_length() -> None:
    cell, spec = palletizing_cell(), mujoco.MjSpec()
    cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, visuals=False), visuals=False)
    model = spec.compile()
    tool = model.body(TOOL)
    assert tool.mass[0] == pytest.approx(cell.tool.mass)
    assert tool.pos[2] == pytest.approx(cell.tool.length)
    pads = [geom for geom in range(model.ngeom) if model.geom_contype[geom] == PAD_BIT]
    assert [model.geom_pos[pad][2] + model.geom_size[pad][2] for pad in pads] == pytest.approx([0.0])


def test_seals_are_ordered_from_the_largest_and_lie_in_the_face_of_the_pad() -> None:
    seals = palletizing_cell().tool.seals()
    assert [seal.side for seal in seals] == sorted((seal.side for seal in seals), reverse=True)
    for seal in seals:
        assert np.all(seal.points[:, 2] == 0.0)
        assert np.abs(seal.points).max() <= seal.side / 2


def test_a_seal_that_bears_half_passes_its_limits_at_half_the_load() -> None:
    limits = palletizing_cell().grip
    load = GripLoad(coaxial=0.6 * limits.coaxial_force)
    assert limits.passed_by(load, 1.0) == ()
    (passed,) = limits.passed_by(load, 0.5)
    assert (passed.what, passed.allowed) == ("coaxial force", 0.5 * limits.coaxial_force)
