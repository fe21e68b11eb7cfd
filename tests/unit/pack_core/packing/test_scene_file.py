"""Scene files that cannot be are refused by key, value and what is allowed."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from pack_core.errors import ConfigError
from pack_core.packing.scene_file import load_scene, parse_scene
from pack_core.paths import config_path

EXAMPLE = config_path("scenarios", "packing", "example.yaml")


def refusal(changes: dict[str, Any]) -> str:
    """How the example is refused with dotted keys changed; None removes a key."""
    data = yaml.safe_load(EXAMPLE.read_text())
    for path, value in changes.items():
        *parents, last = [int(part) if part.isdigit() else part for part in path.split(".")]
        place = data
        for part in parents:
            place = place[part]
        if value is None:
            del place[last]
        else:
            place[last] = value
    with pytest.raises(ConfigError) as caught:
        parse_scene(yaml.safe_dump(data), "my_scene.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "parts"),
    [
        ("objects.0.shape", "sphere", ["objects.0.shape", "sphere", "'box', 'cylinder'"]),
        ("objects.0.shape", None, ["objects.0.shape", "missing"]),
        ("objects.0.radius", -0.03, ["objects.0.cylinder.radius", "-0.03", "greater than 0.005"]),
        ("objects.2.size", [0.1, 0.1], ["objects.2.box.size", "missing"]),
        ("objects.2.radius", 0.1, ["objects.2.box.radius", "not known"]),
        ("objects.0.mass", 400, ["objects.0.cylinder.mass", "400", "less than or equal to 20"]),
        ("objects.0.name", "Soup Can", ["objects.0.cylinder.name", "Soup Can", "a-z"]),
        ("objects.0.name", "tea_box", ["tea_box", "every object its own"]),
        ("objects.0.name", "table", ["table", "the cell itself"]),
        ("objects.0.pose", None, ["soup_can", "pose"]),
        ("objects.0.pose.position", [0.4, float("nan"), 0.05], ["position.1", "nan", "finite"]),
        ("objects.2.pose.quaternion", [1, 0, 0, 0], ["objects.2.box.pose", "not both"]),
        ("objects.3.pose.quaternion", [1, 1, 0, 0], ["objects.3.box.pose", "length 1"]),
        ("objects.0.pose.position", [0.3, 0.0, 0.055], ["objects.soup_can.pose", "x 0.365 to 0.635"]),
        ("objects.0.pose.position", [0.422, -0.027, 0.02], ["objects.soup_can.pose", "z -0.035", "z from 0"]),
        ("objects.0.pose.position", [0.45, -0.027, 0.055], ["soup_can", "cracker_box", "mm; allowed: up to"]),
        ("objects.4.size", [0.4, 0.07, 0.11], ["objects.sugar_box.pose", "y -0.110 to 0.110"]),
        ("friction", 0, ["friction", "greater than or equal to 0.01"]),
        ("container.height", None, ["container.height", "missing"]),
        ("container.size", [0.27, 2.0], ["container.size.1", "2.0", "less than 0.8"]),
        ("container.centre", [0.9, 0.0], ["container", "at most 0.75 m"]),
        ("new_object", None, ["new_object", "missing"]),
        ("new_object.mass", 2.5, ["new_object.mass", "2.5", "2.3 kg"]),
        ("new_object.size", [0.3, 0.3, 0.1], ["new_object", "0.300 x 0.300", "0.270 x 0.220"]),
        ("new_object.size", [0.06, 0.06, 0.24], ["new_object", "0.240 m tall", "less than 0.240 m"]),
        ("new_object.pose", {"position": [0.5, 0, 0.5]}, ["new_object.pose", "none"]),
        ("colour", [1, 0, 0], ["colour", "not known"]),
    ],
)  # fmt: skip
def test_a_bad_value_is_named_with_what_is_allowed(key: str, value: Any, parts: list[str]) -> None:
    message = refusal({key: value})
    for part in ["my_scene.yaml", *parts]:
        assert part in message


def test_what_follows_from_a_wrong_value_is_no_error_besides() -> None:
    message = refusal({"new_object.mass": "heavy"})
    assert "new_object.box.mass" in message
    assert "colour" not in message


def test_a_new_object_that_hangs_into_the_container_is_refused() -> None:
    message = refusal({"container.height": 0.45, "new_object.size": [0.06, 0.06, 0.4]})
    assert "new_object" in message
    assert "before the arm has moved" in message


def test_overlaps_of_measured_size_are_accepted() -> None:
    data = yaml.safe_load(EXAMPLE.read_text())
    x, y, z = data["objects"][0]["pose"]["position"]
    data["objects"][0]["pose"]["position"] = [x, y, z - 0.003]
    assert parse_scene(yaml.safe_dump(data), "measured").poses()["soup_can"].p[2] == z - 0.003


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no such file"):
        load_scene(tmp_path / "none.yaml")
