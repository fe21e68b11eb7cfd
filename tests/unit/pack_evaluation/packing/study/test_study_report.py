import re
from pathlib import Path

from PIL import Image

from pack_core.packing.exit_reason import ExitReason
from pack_evaluation.packing.study.failures import FailurePicture
from pack_evaluation.packing.study.report import write_study_report
from pack_evaluation.packing.study.trial import Study
from unit.pack_evaluation.packing.study.test_summary import failed, packed


def test_a_report_needs_nothing_beside_it_and_shows_every_failure(tmp_path: Path) -> None:
    trials = (packed("seed_1"), failed("seed_2", ExitReason.TIMEOUT), failed("seed_3", ExitReason.FORCE))
    picture = tmp_path / "seed_2.png"
    Image.new("RGB", (4, 4)).save(picture)
    study = Study("pack_it_in, ilqr", trials, {"weights": "tuned"})
    shown = [FailurePicture(trials[1], picture, None)]
    text = write_study_report([study], tmp_path, title="Benchmark", pictures=shown).read_text()
    assert "http" not in text
    assert all(source.startswith("data:image/png;base64,") for source in re.findall(r'src="([^"]*)"', text))
    assert re.findall(r"<b>(seed_\d)</b>", text) == ["seed_2", "seed_3"]
    assert text.count('<img alt="seed_2"') == 1
    assert "pack_it_in, ilqr" in text
    assert "<td>weights</td><td>tuned</td>" in text
