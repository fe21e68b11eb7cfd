"""What a trial of the benchmark keeps beside its measures."""

from __future__ import annotations

from pathlib import Path

from pack_evaluation.palletizing.plots import visitors_picture
from pack_lockstep.palletizing.benchmark import FILES, PalletBenchmark
from pack_lockstep.palletizing.settings import set_up
from unit.pack_evaluation.palletizing.known_run import a_run
from unit.pack_evaluation.palletizing.test_state_times import NEAR, RUN


def test_the_visitors_plot_of_a_trial_is_kept_as_a_file_and_not_among_its_results(tmp_path: Path) -> None:
    picture = visitors_picture(a_run(visitors={"person": NEAR}))
    assert picture is not None
    assert visitors_picture(RUN) is None
    setup = set_up(vision=False)
    kept = PalletBenchmark(setup, ()).keep(
        {"name": "a_seed0", FILES: {"visitors/a_seed0.png": picture}}, tmp_path
    )
    assert kept == {"name": "a_seed0"}
    assert (tmp_path / "visitors" / "a_seed0.png").read_bytes().startswith(b"\x89PNG")
