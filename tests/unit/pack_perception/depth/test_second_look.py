"""What two looks while objects are pushed make of what was hidden, and of what is seen better."""

from dataclasses import replace

import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Pose, exp
from pack_perception.depth.look import SeenShape
from pack_perception.depth.second_look import (
    KnownObject,
    LookFinding,
    SecondLooks,
    confirmed,
    findings,
    have_moved,
    is_seen_through,
    which_is_which,
    with_shapes,
)
from pack_perception.depth.sight_lines import SightLines
from pack_perception.perception_config import LookAgainConfig

CONFIG = LookAgainConfig()
SURE, UNSURE = 0.001, 0.02


def how_sure(length: float) -> SeenDeviations:
    return SeenDeviations(position=(length, 0.001, 0.001), size=(length, 0.001, 0.001), yaw=0.01)


def fit_of(x: float, length: float, sigma: float) -> SeenShape:
    item = Box(name="seen_9", mass=0.3, shape="box", size=(length, 0.05, 0.1))
    return SeenShape(item, Pose(np.array([x, 0.0, 0.05])), 0.9, np.zeros((0, 3)), how_sure(sigma))


def known(x: float, length: float, sigma: float, *, lean: float = 0.0) -> KnownObject:
    item = Box(name="seen_1", mass=0.3, shape="box", size=(length, 0.05, 0.1))
    q = exp(np.array([lean, 0.0, 0.0]))
    return KnownObject(item, Pose(np.array([x, 0.0, 0.05]), q), how_sure(sigma))


def test_a_shape_that_is_surer_takes_the_place_of_one_that_was_half_hidden() -> None:
    (found,) = findings([fit_of(0.51, 0.09, SURE)], [known(0.5, 0.07, UNSURE)], CONFIG)
    assert found.name == "seen_1"


def test_a_shape_that_goes_on_where_the_known_one_ends_takes_its_place_however_sure() -> None:
    longer = fit_of(0.515, 0.1, UNSURE)
    (found,) = findings([longer], [known(0.5, 0.07, UNSURE)], CONFIG)
    assert found.name == "seen_1"
    assert findings([longer], [known(0.5, 0.07, SURE)], CONFIG) == []
    assert findings([fit_of(0.52, 0.07, UNSURE)], [known(0.5, 0.07, UNSURE)], CONFIG) == []  # shifted


def test_a_shape_stays_that_is_sure_or_leans_or_is_seen_no_better() -> None:
    better = fit_of(0.51, 0.09, SURE)
    assert findings([better], [known(0.5, 0.07, SURE)], CONFIG) == []
    assert findings([better], [known(0.5, 0.07, UNSURE, lean=0.1)], CONFIG) == []
    assert findings([fit_of(0.5, 0.07, 0.9 * UNSURE)], [known(0.5, 0.07, UNSURE)], CONFIG) == []


def test_only_what_is_beside_all_others_is_new() -> None:
    others = [known(0.5, 0.07, SURE)]
    (new,) = findings([fit_of(0.6, 0.04, SURE)], others, CONFIG)
    assert new.name is None
    assert findings([fit_of(0.54, 0.04, SURE)], others, CONFIG) == []  # it stands in another one


def test_what_is_beside_all_others_is_the_lost_object_of_its_size() -> None:
    there, lost = known(0.5, 0.07, SURE), replace(known(0.7, 0.04, SURE), is_lost=True)
    (found,) = findings([fit_of(0.6, 0.045, SURE)], [there, lost], CONFIG)
    assert found.name == "seen_1"
    (other,) = findings([fit_of(0.6, 0.08, SURE)], [there, lost], CONFIG)
    assert other.name is None
    # it hides nothing where it is believed to be, and is looked for there
    assert len(SecondLooks(CONFIG).sure([there, lost])) == 1


def test_each_of_two_alike_objects_is_found_once_also_on_its_side() -> None:
    small = Box(name="small", mass=0.3, shape="box", size=(0.03, 0.04, 0.08))
    large = Box(name="large", mass=0.3, shape="box", size=(0.035, 0.045, 0.085))
    on_side = Box(name="seen_8", mass=0.3, shape="box", size=(0.08, 0.03, 0.04))
    standing = large.model_copy(update={"name": "seen_9"})
    assert which_is_which([on_side, standing], [large, small]) == ["small", "large"]
    assert which_is_which([on_side, standing, on_side], [large]) == [None, "large", None]
    assert which_is_which([on_side], []) == [None]


def test_a_body_that_a_camera_looks_through_is_not_there() -> None:
    # a camera a metre over the table, which measures the table
    camera = PinholeCamera(
        Pose(np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0, 0.0])),
        300.0,
        np.array([160.0, 120.0]),
        320,
        240,
    )
    box = Box(name="box", mass=0.3, shape="box", size=(0.08, 0.08, 0.1))
    there = Pose(np.array([0.0, 0.0, 0.05]))
    empty = SightLines([camera], np.ones((1, 240, 320)), 0.005)
    assert is_seen_through(box, there, empty)
    # its top is 0.9 m away
    assert not is_seen_through(box, there, SightLines([camera], np.full((1, 240, 320), 0.9), 0.005))
    # nothing measured says nothing
    assert not is_seen_through(box, there, SightLines([camera], np.zeros((1, 240, 320)), 0.005))


def test_what_was_seen_once_or_elsewhere_is_not_believed() -> None:
    here, there = (LookFinding(fit_of(x, 0.04, SURE), None) for x in (0.6, 0.7))
    assert confirmed([here], []) == []
    assert confirmed([here], [there]) == []
    assert confirmed([here], [LookFinding(fit_of(0.602, 0.04, SURE), None)]) == [here]
    assert confirmed([here], [LookFinding(fit_of(0.6, 0.04, SURE), "seen_1")]) == []


def test_a_look_is_worth_it_once_something_has_moved_or_is_new() -> None:
    before = {"seen_1": np.zeros(3)}
    assert not have_moved({"seen_1": np.array([0.5 * CONFIG.moved, 0.0, 0.0])}, before, CONFIG)
    assert have_moved({"seen_1": np.array([2.0 * CONFIG.moved, 0.0, 0.0])}, before, CONFIG)
    assert have_moved({"seen_1": np.zeros(3), "seen_2": np.zeros(3)}, before, CONFIG)


def test_two_looks_in_a_row_are_believed_and_the_second_one_waits() -> None:
    looks, here = SecondLooks(CONFIG), {"seen_1": np.zeros(3)}
    assert looks.is_worth_it(0.0, here)
    looks.note(0.0, here)
    assert not looks.is_worth_it(2.0 * CONFIG.period, here)
    assert not looks.is_worth_it(0.5 * CONFIG.period, {"seen_1": np.ones(3)})
    others, new = [known(0.5, 0.07, SURE)], fit_of(0.6, 0.04, SURE)
    assert looks.believed([new], others) == {}
    assert looks.is_worth_it(2.0 * CONFIG.period, here)  # what was seen once
    assert looks.believed([new], others) == {"seen_9": new}
    assert not looks.is_worth_it(2.0 * CONFIG.period, here)


def test_a_better_known_object_keeps_its_name_and_colour_and_a_new_one_comes_last() -> None:
    scene, better, new = packing_cell().scene, fit_of(0.5, 0.1, SURE), fit_of(0.6, 0.04, SURE)
    name = scene.names[0]
    after = with_shapes(scene, {name: better, "seen_9": new})
    assert after.names == [*scene.names, "seen_9"]
    assert after.objects[0].half_extents.tolist() == better.item.half_extents.tolist()
    assert after.objects[0].colour == scene.objects[0].colour
    assert after.objects[1:-1] == scene.objects[1:]
