"""Scenes that cannot be are refused; those that the project itself makes never are."""

import pytest

from pack_core.errors import ConfigError
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene, parse_scene
from pack_core.paths import config_path
from pack_core.pose_config import PoseConfig

EXAMPLE = config_path("scenarios", "packing", "example.yaml")


def moved(by: tuple[float, float, float], *, quaternion: tuple[float, ...] | None = None) -> Scene:
    """The example with its first object displaced [m]."""
    scene = load_scene(EXAMPLE)
    first, *others = scene.objects
    p = [a + b for a, b in zip(first.pose.position, by, strict=True)]
    q = quaternion or first.pose.to_pose().q.tolist()
    pose = PoseConfig(position=tuple(p), quaternion=tuple(q))
    return scene.model_copy(update={"objects": [first.model_copy(update={"pose": pose}), *others]})


@pytest.mark.parametrize(
    ("height", "words"),
    [
        (0.05, "leaves it in the air, 50 mm over the base; allowed: at most 10 mm"),
        (0.3, "above the rim; allowed: below 0.120 m"),
    ],
)
def test_objects_that_nothing_carries_are_refused(height: float, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_scene(moved((0.0, 0.0, height)).to_yaml(), "scene")
    assert words in str(caught.value)


def test_an_object_as_high_as_a_measurement_is_wrong_is_allowed() -> None:
    scene = moved((0.0, 0.0, 0.008))
    assert parse_scene(scene.to_yaml(), "scene").objects == scene.objects


def test_an_object_on_another_is_carried() -> None:
    scene = load_scene(EXAMPLE)
    first, second, *others = scene.objects
    x, y, height = first.pose.position[0], first.pose.position[1], 2 * first.half_extents[2]
    q = tuple(first.pose.to_pose().q.tolist())

    def with_second_at(z: float) -> str:
        pose = PoseConfig(position=(x, y, z), quaternion=q)
        lifted = second.model_copy(update={"pose": pose})
        return scene.model_copy(update={"objects": [first, lifted, *others]}).to_yaml()

    assert height < scene.container.height
    parse_scene(with_second_at(height + second.half_extents[2]), "scene")
    with pytest.raises(ConfigError, match=r"in the air|above the rim"):
        parse_scene(with_second_at(height + second.half_extents[2] + 0.02), "scene")


def test_an_object_in_the_arm_is_refused() -> None:
    scene = load_scene(EXAMPLE)
    box = next(item for item in scene.objects if item.shape == "box")

    def with_pillar(x: float) -> str:
        pillar = {"size": (0.06, 0.06, 1.5), "pose": PoseConfig(position=(x, 0.0, 0.75))}
        return scene.model_copy(update={"objects": [box.model_copy(update=pillar)]}).to_yaml()

    with pytest.raises(ConfigError, match="into the arm at home"):
        parse_scene(with_pillar(0.41), "scene")


def test_a_quaternion_of_few_digits_is_brought_to_length_one() -> None:
    pose = PoseConfig(position=(0, 0, 0), quaternion=(0.707, 0.0, 0.0, 0.707)).to_pose()
    assert pose.q @ pose.q == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass: ", "mass: 1.0e-16 #", "greater than or equal to 0.001"),
        ("mass: ", "mass: true #", "a number, not true or false"),
        ("friction: ", "friction: 1.0e-300 #", "greater than or equal to 0.01"),
        ("centre: ", "centre: [.nan, 0.0] #", "container.centre"),
    ],
)
def test_nonsense_numbers_are_named(old: str, new: str, words: str) -> None:
    text = load_scene(EXAMPLE).to_yaml().replace("  centre:\n  - 0.5\n  - 0.0\n", "  centre: [0.5, 0.0]\n")
    with pytest.raises(ConfigError) as caught:
        parse_scene(text.replace(old, new, 1), "scene")
    assert words in str(caught.value)
    assert ", line " in str(caught.value)
