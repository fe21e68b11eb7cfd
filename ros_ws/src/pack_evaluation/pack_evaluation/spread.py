"""Statistics of a measure over trials, and how well it separates failures from successes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import numpy.typing as npt

Values = Sequence[float] | npt.NDArray[np.float64]
PARTS = {"mean": "mean", "p95": "95th percentile", "max": "largest"}
"""Keys of the result of `mean_p95_max`, with their names in tables."""


@dataclass(frozen=True)
class Spread:
    """Mean, standard deviation, median and 95th percentile; None where there are no values."""

    mean: float | None
    deviation: float | None
    median: float | None
    p95: float | None


def spread(values: Values) -> Spread:
    """The spread of the values that are numbers; NaN, a measure that a trial does not have, is left out."""
    array = _numbers(values)
    if not array.size:
        return Spread(None, None, None, None)
    median, p95 = np.percentile(array, (50, 95))
    return Spread(float(array.mean()), float(array.std()), float(median), float(p95))


@dataclass(frozen=True)
class Split:
    """A measure of trials that succeeded and of those that failed.

    Attributes:
        success: statistics of the trials that succeeded.
        failure: statistics of the trials that failed.
        auc: probability that a failure measures more than a success; 0.5 means no information, None that one
            of the groups is empty.
    """

    success: Spread
    failure: Spread
    auc: float | None

    def to_json(self) -> dict[str, object]:
        """As plain values."""
        return asdict(self)


def split(success: Values, failure: Values) -> Split:
    """Statistics of a measure by outcome, and how well the measure predicts the outcome."""
    return Split(spread(success), spread(failure), auc(success, failure))


def auc(success: Values, failure: Values) -> float | None:
    """P(failure > success) + P(equal) / 2 over all pairs (Mann and Whitney); None for no pair."""
    low, high = _numbers(success), _numbers(failure)
    if not low.size or not high.size:
        return None
    from scipy.stats import mannwhitneyu  # a second, which whoever compares nothing saves

    # U of Mann and Whitney counts the pairs; its p-value is not asked for, and the quickest one is computed.
    pairs_won = mannwhitneyu(high, low, method="asymptotic").statistic
    return float(pairs_won / (low.size * high.size))


def mean(values: Sequence[float]) -> float | None:
    """The mean; None where there are no values."""
    return float(np.mean(values)) if len(values) else None


def mean_p95_max(values: Sequence[float]) -> dict[str, float | None]:
    """Mean, 95th percentile and largest of a measure; None where there are no values."""
    if not values:
        return dict.fromkeys(PARTS)
    array = np.array(values, dtype=float)
    p95 = float(np.percentile(array, 95))
    return {"mean": float(array.mean()), "p95": p95, "max": float(array.max())}


def spread_text(values: Mapping[str, float | None], digits: int = 2) -> str:
    """The result of `mean_p95_max` as text for a table's cell; a missing part is a dash."""
    parts = (values.get(part) for part in PARTS)
    return "   ".join("-" if value is None else f"{value:.{digits}f}" for value in parts)


def _numbers(values: Values) -> npt.NDArray[np.float64]:
    array = np.asarray(values, dtype=float)
    return np.asarray(array[~np.isnan(array)])
