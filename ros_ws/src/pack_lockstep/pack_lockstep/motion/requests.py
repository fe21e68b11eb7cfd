"""Motion requests as they were put to an arm, and the files that keep them."""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from pathlib import Path as FilePath
from typing import Any, get_type_hints

import numpy as np

from pack_core.errors import ConfigError
from pack_core.motion.moves import JointMove, Line, Mode, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_motion.reference.trajectory import JointState


@dataclass(frozen=True)
class MotionRequest:
    """A target, and the state in which an arm was asked for it.

    Attributes:
        name: unique in its file.
        cell: the cell of the arm.
        start: the commanded state of the joints.
        target: what was asked for.
    """

    name: str
    cell: str
    start: JointState
    target: MotionTarget


KIND = "kind"
"""Key of the name of a value's class."""
CLASSES: Mapping[str, type] = {
    cls.__name__: cls
    for cls in (
        MotionRequest, JointState, MotionTarget, ReachTolerance, Transfer, Path, Retreat, Line, PoseMove,
        JointMove, CarriedBox, Obstacle, Pose,
    )
}  # fmt: skip
"""The classes whose values may stand in a file, by name."""


def request_file(name: str) -> FilePath:
    """The file of a set of requests, config/requests/<name>.jsonl.gz."""
    return config_path("requests", f"{name}.jsonl.gz")


def load_requests(path: FilePath) -> list[MotionRequest]:
    """The requests of a file, as they were saved, to the last bit.

    Raises:
        ConfigError: there is no such file, or it is none of requests.
    """
    try:
        with gzip.open(path, "rt") as file:
            requests = [_value(json.loads(line)) for line in file]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ConfigError(f"{path} is no file of motion requests: {error}") from error
    if not all(isinstance(request, MotionRequest) for request in requests):
        raise ConfigError(f"{path} has lines that are no motion requests")
    return requests


def save_requests(path: FilePath, requests: Sequence[MotionRequest]) -> None:
    """Write requests, one a line; equal requests make equal files."""
    lines = "".join(json.dumps(_plain(request), separators=(",", ":")) + "\n" for request in requests)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(lines.encode(), mtime=0))


def _plain(value: Any) -> Any:
    """A value as JSON knows it; of a dataclass without what is as by default."""
    if is_dataclass(value) and not isinstance(value, type):
        own = {
            field.name: _plain(getattr(value, field.name)) for field in fields(value)
            if not _is_default(getattr(value, field.name), field.default)
        }  # fmt: skip
        return {KIND: type(value).__name__, **own}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (tuple, frozenset)):
        items = sorted(value) if isinstance(value, frozenset) else value
        return [_plain(item) for item in items]
    return value


def _is_default(value: Any, default: Any) -> bool:
    return default is not MISSING and not isinstance(value, np.ndarray) and bool(value == default)


def _value(plain: Any) -> Any:
    """The dataclass that `_plain` made a mapping of."""
    cls = CLASSES[plain[KIND]]
    hints = get_type_hints(cls)
    return cls(**{name: _typed(item, hints[name]) for name, item in plain.items() if name != KIND})


def _typed(item: Any, hint: Any) -> Any:
    """A field's value, of the type that its class declares."""
    if isinstance(item, dict):
        return _value(item)
    if hint is Mode:
        return Mode(item)
    if isinstance(item, list):
        origin = getattr(hint, "__origin__", None)
        if origin in (tuple, frozenset):
            return origin(_value(one) if isinstance(one, dict) else one for one in item)
        return np.array(item, dtype=float)
    return item
