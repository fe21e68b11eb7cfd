"""The pages show what the files of results say, and no published figure comes from a seed for tuning."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from pack_bringup.robustness.live import seeds_of
from pack_core.paths import project_root
from pack_evaluation.provenance import project_version
from pack_lockstep.results.definitions import BenchmarkDefinition, load_definitions, results_path
from pack_lockstep.results.pages import pages, with_tables
from pack_lockstep.results.published import file_of, load_result

DEFINITIONS = load_definitions()
ROOT = project_root()
RESULTS = {
    name: result
    for name in DEFINITIONS.benchmarks
    if (result := load_result(file_of(name, results_path()))) is not None
}
FIRST_SEED = {"packing": "--seed", "palletizing": "--first-seed", "blocks": "--seed"}
COUNT = {"packing": "--scenes", "palletizing": "--seeds", "blocks": "--instances"}


@pytest.mark.parametrize("page", pages(ROOT), ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_shows_what_the_files_say(page: Path) -> None:
    text = page.read_text()
    assert with_tables(text, RESULTS, project_version()) == text, "pack results tables"


def test_every_file_is_of_a_benchmark_that_is_defined() -> None:
    found = {str(path.relative_to(results_path()).with_suffix("")) for path in results_path().rglob("*.json")}
    assert found <= DEFINITIONS.benchmarks.keys()


@pytest.mark.parametrize("name", DEFINITIONS.benchmarks)
def test_no_figure_comes_from_a_seed_for_tuning(name: str) -> None:
    cell = name.partition("/")[0]
    tuning, own = DEFINITIONS.tuning_seeds[cell], seeds(cell, DEFINITIONS.benchmarks[name])
    assert own.stop <= tuning.first or own.start > tuning.last, (own, tuning)


def seeds(cell: str, definition: BenchmarkDefinition) -> range:
    """The seeds that a benchmark runs, where its command gives them as numbers behind options."""
    options = dict(pairwise(definition.arguments))
    if definition.is_live:
        return seeds_of(options["--seeds"])
    is_shift = "--shift" in definition.arguments
    first = int(options.get("--seed" if is_shift else FIRST_SEED[cell], 0))
    return range(first, first + int(options["--streams" if is_shift else COUNT[cell]]))
