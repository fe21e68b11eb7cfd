"""Measures of many fill jobs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pack_core.errors import ConfigError
from pack_evaluation.packing.fill.studies import STUDIES
from pack_evaluation.study import KeptTrials


def trial(name: str, **changes: Any) -> dict[str, Any]:
    return {
        "name": name, "without_fault": True, "objects": 6, "given": 8, "base_area": 0.7, "volume": 0.4,
        "durations": [6.0, 8.0], "force": 20.0, "fills": [[0.0, 0.0, 0.0], [7.0, 0.4, 0.2], [14.0, 0.7, 0.4]],
        **changes,
    }  # fmt: skip


def kept(*trials: dict[str, Any]) -> KeptTrials:
    return KeptTrials(Path("somewhere"), {"name": "fill contact ideal"}, {}, trials)


def test_the_summary_has_exactly_the_keys_that_others_read() -> None:
    other = trial("seed_1", without_fault=False, objects=4, base_area=0.5, durations=[10.0], force=41.0)
    (study,) = STUDIES.of_benchmark(kept(trial("seed_0"), other))
    assert STUDIES.summary(study) == {
        "lists": 2, "without_fault": 1, "objects": 5.0, "base_area": pytest.approx(0.6), "volume": 0.4,
        "time_per_object_s": 8.0, "contact_force_N": 41.0,
    }  # fmt: skip


def test_no_lists_have_no_means() -> None:
    (study,) = STUDIES.of_benchmark(kept())
    summary = STUDIES.summary(study)
    assert summary["lists"] == 0
    assert summary["objects"] is summary["contact_force_N"] is None


def test_a_trial_of_another_version_is_refused() -> None:
    old = trial("seed_0")
    del old["fills"]
    with pytest.raises(ConfigError, match="fills"):
        STUDIES.of_benchmark(kept(old))


def test_tables_and_the_figure_show_every_list(tmp_path: Path) -> None:
    studies = STUDIES.of_benchmark(kept(trial("seed_0"), trial("seed_1")))
    overview, lists = STUDIES.tables(studies)
    assert overview.rows[0][:3] == ("fill contact ideal", "2/2", "6.00")
    assert [row[0] for row in lists.rows] == ["seed_0", "seed_1"]
    (figure,) = STUDIES.figures(studies, tmp_path / "figures")
    assert figure.stat().st_size > 1000
