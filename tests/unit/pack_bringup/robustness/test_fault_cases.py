"""Which faults are tried, and how a report reads."""

from __future__ import annotations

from dataclasses import asdict

import pytest

from pack_bringup.graph.graph import load_graph
from pack_bringup.robustness.fault_cases import (
    FAULT_COLUMNS,
    STAGES,
    Fault,
    FaultReport,
    fault_cases,
    fault_row,
)
from pack_core.cells import CELLS
from pack_core.errors import ConfigError
from pack_lockstep.benchmarking.results_folder import plain


@pytest.mark.parametrize("cell", CELLS)
def test_every_node_gets_every_fault_in_every_stage_under_a_name_of_its_own(cell: str) -> None:
    cases = list(fault_cases(cell))
    assert len({case.name for case in cases}) == len(cases)
    assert len(cases) == len(load_graph(cell).nodes) * len(Fault) * len(STAGES[cell])


def test_cases_can_be_chosen_and_unknown_names_are_refused_with_those_that_exist() -> None:
    chosen = list(fault_cases("packing", ["mpc"], [Fault.KILL], ["INSERT"]))
    assert [case.name for case in chosen] == ["kill mpc in INSERT"]
    with pytest.raises(ConfigError, match="no node 'fsm'; allowed: sim, perception"):
        list(fault_cases("packing", ["fsm"]))
    with pytest.raises(ConfigError, match="no stage 'DANCE'; allowed: PRE_PACK, INSERT"):
        list(fault_cases("packing", stages=["DANCE"]))


def test_a_report_reads_as_a_row_after_it_was_kept_as_json() -> None:
    report = FaultReport(
        "kill mpc in INSERT", "mpc", "kill", "INSERT", speed=0.9, brakes_after=0.05,
        stands_after=float("inf"), was_held=True, named_by=("recorder", "sim"), goal="fault",
    )  # fmt: skip
    row = dict(zip(FAULT_COLUMNS, fault_row(plain(asdict(report))), strict=False))
    assert row["brakes after [s sim.]"] == "0.05"
    assert row["stands after [s sim.]"] == "goes on"
    assert row["held object"] == "LOST"
    assert row["named by"] == "recorder, sim"
    assert row["next goal works"] == "NO"
