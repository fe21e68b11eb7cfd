"""How a goal that is not taken says so: by a result, as ROS 2 has no words for a rejected goal."""

from __future__ import annotations

from typing import Any

REFUSED = "refused: "
"""How the message of a goal's result begins when the goal was not taken; the reason follows."""


def refused_result(kind: type[Any], reason: str) -> Any:
    """The result, of an action's result type, of a goal that is not taken for this reason."""
    result = kind(success=False, message=REFUSED + reason)
    if hasattr(result, "exit_reason"):
        result.exit_reason = "refused"
    return result
