"""Studies of hand-made runs, whose summaries are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.packing.exit_reason import PackingExitReason
from pack_evaluation.packing.study.summary import contact_force, exits, summarize
from pack_evaluation.packing.study.tables import tables
from pack_evaluation.packing.study.trial import PackingStudy, PackingTrial, trial_of
from unit.pack_evaluation.packing.runs import START, iterations, make_run


def packed(name: str, seconds: float = 4.0, force: float = 0.0) -> PackingTrial:
    times = np.linspace(0.0, 8.0, 801)
    run = make_run(end=START + seconds, force=np.full(times.size, force), outcome={"message": "within 15 mm"})
    return trial_of(name, run)


def failed(name: str, reason: PackingExitReason, seconds: float = 4.0) -> PackingTrial:
    outcome = {"exit_reason": reason.value, "success": False, "message": "stuck"}
    run = make_run(end=START + seconds, iterations=iterations(("PRE_PACK", "INSERT")), outcome=outcome)
    return trial_of(name, run)


def study_of(name: str, *trials: PackingTrial) -> PackingStudy:
    return PackingStudy(name=name, trials=trials)


def test_successes_and_exits_are_counted() -> None:
    study = study_of("ours", packed("a"), packed("b"), failed("c", PackingExitReason.TIMEOUT))
    summary = summarize(study)
    assert (summary["scenes"], summary["success"], summary["first_attempt"]) == (3, 2, 2)
    assert summary["exits"] == exits(study) == {"placed": 2, "timeout": 1}
    assert summary["failures"] == [{"scene": "c", "exit": "timeout", "message": "stuck"}]


def test_force_stops_and_detachments_do_not_count_in_the_execution_time() -> None:
    early = [failed("c", PackingExitReason.FORCE, 1.0), failed("d", PackingExitReason.DETACHED, 1.0)]
    summary = summarize(study_of("ours", packed("a", 3.0), packed("b", 5.0), *early))
    assert summary["execution_time_s"]["mean"] == pytest.approx(4.0)


def test_mean_force_pools_samples_and_the_mean_of_trials_pools_trials() -> None:
    study = PackingStudy(
        name="ours", trials=(packed("short", 1.0, force=6.0), packed("long", 3.0, force=2.0))
    )
    force = contact_force(study)
    assert force["mean"] == pytest.approx((101 * 6.0 + 301 * 2.0) / 402)
    assert force["mean_of_trials"] == pytest.approx(4.0)
    assert force["deviation_of_trials"] == pytest.approx(2.0)
    assert force["mean_peak"] == pytest.approx(4.0)
    assert force["max_peak"] == pytest.approx(6.0)
    assert force["p95"] == pytest.approx(6.0)


def test_failure_metrics_are_split_by_outcome() -> None:
    bad = failed("bad", PackingExitReason.TIMEOUT)
    bad = replace(bad, measures=replace(bad.measures, m_rot=np.deg2rad(5.0)))
    metric = summarize(study_of("ours", packed("a"), packed("b"), bad))["failure_metrics"]["m_rot_deg"]
    assert metric["success"]["mean"] == pytest.approx(0.0, abs=1e-9)
    assert metric["failure"]["mean"] == pytest.approx(5.0)
    assert metric["auc"] == 1.0


def test_a_study_without_trials_has_a_summary_and_tables() -> None:
    empty = study_of("none")
    assert summarize(empty)["distance_cm"]["mean"] is None
    assert contact_force(empty)["max_peak"] is None
    assert all(len(row) == len(table.head) for table in tables([empty]) for row in table.rows)


def test_the_first_table_has_a_row_a_study_and_a_column_an_exit() -> None:
    ours = study_of("ours", packed("a"), failed("b", PackingExitReason.NO_PLACEMENT))
    theirs = PackingStudy(
        name="theirs", trials=(failed("a", PackingExitReason.FORCE), failed("b", PackingExitReason.TIMEOUT))
    )
    table = tables([ours, theirs])[0]
    columns = dict(zip(table.head, zip(*table.rows, strict=True), strict=True))
    assert columns[""] == ("ours", "theirs")
    assert columns["success"] == ("1/2", "0/2")
    assert columns["timeout"] == ("0", "1")
    assert columns["force"] == ("0", "1")
    assert columns["detached"] == ("0", "0")
    assert columns["no placement"] == ("1", "0")
    assert columns["time [s]"] == ("4.00 ± 0.00", "4.00 ± 0.00")
