"""The measures of a run in words, for terminals and reports alike."""

from __future__ import annotations

import math

from pack_evaluation.packing.metrics import Measures
from pack_evaluation.table import Row


def table_rows(m: Measures) -> tuple[Row, ...]:
    """The measures, most important first."""
    return (
        Row("packed", "yes" if m.success else "no", "stage FINE-TUNE was reached"),
        Row("exit", m.exit_reason.value, "how the goal ended"),
        Row("execution time", _number(m.execution_time, "s"), "simulated, from the goal to its end"),
        Row(
            "final distance",
            _number(1e2 * m.distance, "cm"),
            "from the object to its packing pose, true",
        ),
        Row("force, mean", _number(m.force_mean, "N"), "load on the cup less the object's weight"),
        Row("force, 95 %", _number(m.force_p95, "N"), "percentile of it"),
        Row("force, peak", _number(m.force_peak, "N"), "its maximum, behind a 5 ms low-pass"),
        Row("MPC iteration", _number(m.iteration_ms, "ms", 1), f"wall clock, median of {m.iterations}"),
        Row("MPC iteration, 95 %", _number(m.iteration_ms_p95, "ms", 1), "percentile of it"),
        Row("placements", str(m.placements), "packing poses that were tried"),
        Row("displacement", _number(1e2 * m.displacement, "cm"), "of the objects in the container, summed"),
        Row("M_pos", _number(1e3 * m.m_pos, "mm"), "error of the estimated positions (Eq. 7)"),
        Row("M_rot", _number(math.degrees(m.m_rot), "deg"), "error of the held object's rotation (Eq. 8)"),
        Row("M_per", _number(m.m_per, "objects"), "not seen but predicted, on average (Eq. 9)"),
        Row("real-time factor", _number(m.real_time_factor, ""), "simulated seconds a second, achieved"),
    )


def _number(value: float, unit: str, digits: int = 2) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f} {unit}".strip()
