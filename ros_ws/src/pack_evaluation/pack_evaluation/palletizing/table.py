"""The measures of a run of the palletizing cell in words."""

from __future__ import annotations

import numpy as np

from pack_evaluation.palletizing.measures import OrderMeasures
from pack_evaluation.table import Row


def order_rows(m: OrderMeasures) -> tuple[Row, ...]:
    """The measures, most important first."""
    errors = [box.error_mm for box in m.boxes if box.error_mm is not None]
    cycles = [box.cycle_s for box in m.boxes if box.cycle_s is not None]
    return (
        Row("complete", "yes" if m.is_complete else "no", "every box within 5 mm and 1 degree"),
        Row("reward, penalty", f"{m.reward}, {m.penalty}", "boxes within and not within"),
        Row("placement error", _mean_max(errors, "mm"), "mean, largest; at the end, true"),
        Row("tracking, position", _pair(m.position_mm, "mm"), "mean, largest; commanded to measured tool"),
        Row("tracking, orientation", _pair(m.orientation_deg, "deg"), "mean, largest"),
        Row("at goals", _pair(m.goal_mm, "mm"), "mean, largest; where the gripper acted"),
        Row("shift of earlier boxes", _mean_max(m.shift_mm, "mm"), "mean, largest of each placement"),
        Row("cycle", _mean_max(cycles, "s"), "mean, longest; simulated"),
        Row("drops", str(m.drops), "boxes that the gripper lost"),
        Row("unwanted contacts", str(m.touches), "over 20 N"),
        Row(
            "interruptions",
            str(m.interruptions),
            "setpoints too late, the driver held the arm: a slow machine",
        ),
        Row("faults", str(len(m.faults)), "; ".join(m.faults) or "none"),
        Row("duration", f"{m.duration_s:.1f} s", "simulated"),
    )


def _pair(values: tuple[float, float], unit: str) -> str:
    return f"{values[0]:.3f}, {values[1]:.3f} {unit}"


def _mean_max(values: list[float] | tuple[float, ...], unit: str) -> str:
    return f"{np.mean(values):.2f}, {np.max(values):.2f} {unit}" if values else "-"
