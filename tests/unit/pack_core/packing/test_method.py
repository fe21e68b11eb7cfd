"""What each packing method knows, as section IV-A has it."""

import pytest

from pack_core.errors import ConfigError
from pack_core.packing.goals import PackingMethod


def test_each_baseline_lacks_one_of_two_things() -> None:
    lacks_pose, lacks_physics = PackingMethod.UNINFORMED_POSE, PackingMethod.UNINFORMED_PHYSICS
    assert PackingMethod.PACK_IT_IN.knows_objects
    assert lacks_pose.knows_objects
    assert not lacks_physics.knows_objects
    assert lacks_pose.placement_variant == "random"
    assert lacks_physics.placement_variant == "algorithm_1"


def test_a_wrong_method_is_refused_with_the_known_ones() -> None:
    allowed = "pack_it_in, uninformed_pose, uninformed_physics"
    with pytest.raises(ConfigError, match=f"'magic'; allowed: {allowed}"):
        PackingMethod.of("magic")
