"""Studies of hand-made runs, whose summaries are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.studies import tables
from pack_evaluation.packing.summary import (
    PackingStudy,
    PackingTrial,
    contact_force,
    exits,
    summarize,
    trial_of,
)
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


def test_containment_is_counted_beside_success() -> None:
    out = packed("out")
    out = replace(
        out, measures=replace(out.measures, is_contained=False, protrusion=0.02, tilt=np.deg2rad(10.0))
    )
    summary = summarize(study_of("ours", packed("in"), out, failed("c", PackingExitReason.TIMEOUT)))
    assert (summary["success"], summary["containment"]["contained"]) == (2, 2)
    assert summary["containment"]["packed_and_contained"] == 1
    assert summary["containment"]["protrusion_mm"]["mean"] == pytest.approx(20.0 / 3)
    assert summary["containment"]["max_protrusion_mm"] == pytest.approx(20.0)
    assert summary["containment"]["tilt_deg"]["mean"] == pytest.approx(10.0 / 3)


def test_chatter_is_the_mean_share_of_the_trials_that_had_contact() -> None:
    def with_chatter(share: float) -> PackingTrial:
        trial = packed("a")
        return replace(trial, measures=replace(trial.measures, chatter=share))

    trials = [with_chatter(share) for share in (0.01, 0.03, float("nan"))]
    assert summarize(study_of("ours", *trials))["chatter_percent"]["mean"] == pytest.approx(2.0)


def test_late_iterations_are_shares_of_all_iterations_of_all_trials() -> None:
    few = replace(packed("a"), iterations_ms=np.array([20.0, 100.0]))
    many = replace(packed("b"), iterations_ms=np.array([20.0, 20.0, 50.0, 48.0, 20.0, 20.0]))
    late = summarize(study_of("ours", few, many))["late_iterations_percent"]
    assert late == {"over_48_ms": 25.0, "over_96_ms": 12.5}


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
    assert summarize(empty)["containment"]["max_protrusion_mm"] is None
    assert summarize(empty)["late_iterations_percent"] == {"over_48_ms": None, "over_96_ms": None}
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


def test_table_ii_has_distance_and_mean_force_of_every_method() -> None:
    names = ("pack_it_in", "uninformed_physics", "uninformed_pose")
    studies = [study_of(name, packed("a", force=2.0), packed("b", force=4.0)) for name in names]
    table = tables(studies)[0]
    columns = dict(zip(table.head, zip(*table.rows, strict=True), strict=True))
    assert columns[""] == names
    assert columns["distance [cm]"] == ("0.00 ± 0.00",) * 3
    assert columns["force [N]"] == ("3.00 ± 1.00",) * 3


def test_the_second_table_says_how_many_end_inside() -> None:
    table = tables([study_of("ours", packed("a"), failed("b", PackingExitReason.TIMEOUT))])[1]
    columns = dict(zip(table.head, table.rows[0], strict=True))
    assert (columns["contained"], columns["of the packed"]) == ("2/2", "1/1")
    assert (columns["protrusion [mm]"], columns["largest"]) == ("0.00 ± 0.00", "0.00")
