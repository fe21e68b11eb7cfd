import re
from pathlib import Path

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.studies import STUDIES
from pack_evaluation.packing.summary import PackingStudy
from pack_evaluation.study_report import study_section, write_study_report
from unit.pack_evaluation.packing.runs import make_run
from unit.pack_evaluation.packing.test_summary import failed, packed


def test_a_report_needs_nothing_beside_it_and_shows_every_failure(tmp_path: Path) -> None:
    trials = (
        packed("seed_1"),
        failed("seed_2", PackingExitReason.TIMEOUT),
        failed("seed_3", PackingExitReason.FORCE),
    )
    study = PackingStudy(
        name="pack_it_in, ilqr", trials=trials, about={"weights": "tuned"}, origin={"commit": "1a2b"},
        load=lambda _: make_run(),
    )  # fmt: skip
    section = study_section(STUDIES, [study], tmp_path, pictures=1)
    text = write_study_report([section], tmp_path, "Benchmark").read_text()
    assert "http" not in text
    assert all(source.startswith("data:image/png;base64,") for source in re.findall(r'src="([^"]*)"', text))
    assert re.findall(r"<b>(seed_\d)</b>", text) == ["seed_2", "seed_3"]
    assert re.findall(r'<img alt="(seed_\d)"', text) == ["seed_2"]
    assert "pack_it_in, ilqr" in text
    assert "<td>weights</td><td>tuned</td>" in text
    assert "<td>commit</td><td>1a2b</td>" in text
