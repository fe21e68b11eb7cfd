"""How sure a look is of each object that it saw, and the topic that tells it."""

from __future__ import annotations

import yaml
from pydantic import NonNegativeFloat

from pack_core.config import Config, parse_config
from pack_core.packing.scene_item import SceneItem

SEEN = "/seen"
"""Topic of the standard deviations of what was seen, as YAML."""

Deviation = NonNegativeFloat
Deviations = tuple[Deviation, Deviation, Deviation]


class SeenDeviations(Config):
    """Standard deviations of one object, when it was seen."""

    position: Deviations
    """Of its middle along its own length and width, and upwards [m]."""
    size: Deviations
    """Of its length, width and height [m]."""
    yaw: Deviation | None = None
    """Of its heading [rad]; None: its shape has none."""


class SeenObjects(Config):
    """What a look tells besides the scene."""

    time: float
    """Of exposure of the images that were looked at [s]."""
    objects: dict[str, SeenDeviations]
    """Standard deviations of all objects that were seen, by name."""

    def to_yaml(self) -> str:
        """The text that `from_yaml` reads."""
        return yaml.safe_dump(self.model_dump(mode="json"), sort_keys=False)

    @classmethod
    def from_yaml(cls, text: str, source: str = SEEN) -> SeenObjects:
        """Read the text of a message; raises ConfigError."""
        return parse_config(cls, text, source)


def in_words(item: SceneItem, deviations: SeenDeviations) -> str:
    """An object's size as it was seen, and how sure that and its place are, in millimetres and degrees."""
    sizes = " x ".join(
        f"{2e3 * half:.0f} ± {1e3 * sigma:.1f}"
        for half, sigma in zip(item.half_extents, deviations.size, strict=True)
    )
    place = f"place ± {1e3 * max(deviations.position):.1f} mm"
    heading = "" if deviations.yaw is None else f", ± {57.2958 * deviations.yaw:.1f}°"
    return f"{sizes} mm, {place}{heading}"
