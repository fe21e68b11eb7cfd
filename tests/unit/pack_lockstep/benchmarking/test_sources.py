"""Which files of the project a result depends on, and what counts as a change of one."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from pack_core.paths import config_path
from pack_lockstep.benchmarking.sources import Traced, code_of, digest, digests, fingerprint

MODULE = '''"""What the module is for."""

RADIUS = 3
"""Of the wheel [m]."""


class Wheel:
    """A wheel."""

    def circumference(self) -> float:
        """Once around."""
        return 2 * 3.14 * RADIUS  # roughly
'''


def edited(text: str, folder: Path, name: str = "wheel.py") -> str:
    path = folder / name
    path.write_text(text)
    return digest(path)


def test_words_about_the_code_do_not_count(tmp_path: Path) -> None:
    before = edited(MODULE, tmp_path)
    for old, new in [
        ("What the module is for.", "Wheels."),
        ("Of the wheel [m].", "Of the wheel [m], from its data sheet."),
        ("Once around.", "Once around.\n\n        Returns:\n            a length [m].\n        "),
        ("  # roughly", ""),
        ("RADIUS = 3\n", "# The largest that fits.\nRADIUS = 3\n\n"),
    ]:
        assert edited(MODULE.replace(old, new), tmp_path) == before, new


def test_every_change_of_the_code_counts(tmp_path: Path) -> None:
    before = edited(MODULE, tmp_path)
    for old, new in [("3.14", "3.1416"), ("RADIUS = 3", 'RADIUS = "3"'), ("2 *", "3 *"), ("Wheel", "Tyre")]:
        assert edited(MODULE.replace(old, new), tmp_path) != before, new


def test_a_text_that_is_used_is_no_docstring(tmp_path: Path) -> None:
    assert edited('a = "b"\n', tmp_path) != edited('a = "c"\n', tmp_path)
    assert edited('f("b")\n', tmp_path) != edited('f("c")\n', tmp_path)
    assert edited('a = "# no comment"\n', tmp_path) != edited('a = "# a comment"\n', tmp_path)


@given(
    st.lists(st.sampled_from(["x = 1", "x = 'é # a'", "", "# ü", '"""doc # é"""', "if x:\n    y = 2  # z"]))
)
def test_code_is_what_python_runs(lines: list[str]) -> None:
    source = "\n".join(lines)
    plain, cut = dict[str, object](), dict[str, object]()
    exec("x = 0\n" + source, plain)  # noqa: S102
    exec("x = 0\n" + code_of(source), cut)  # noqa: S102
    for values in (plain, cut):
        values.pop("__builtins__")
    assert plain == cut


def test_comments_of_a_configuration_do_not_count(tmp_path: Path) -> None:
    before = edited("speed: 1.0  # m/s\n", tmp_path, "a.yaml")
    assert edited("# how fast\nspeed: 1.0\n", tmp_path, "a.yaml") == before
    assert edited("speed: 1.1\n", tmp_path, "a.yaml") != before


def test_a_folder_is_what_it_holds(tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text("1")
    before = digest(tmp_path)
    (tmp_path / "one.json").write_text("2")
    assert digest(tmp_path) == before
    (tmp_path / "two.json").write_text("2")
    assert digest(tmp_path) != before


def test_a_missing_file_has_no_digest() -> None:
    assert digests(["config/no_such_file.yaml"]) == {"config/no_such_file.yaml": ""}


def test_one_other_digest_is_another_fingerprint() -> None:
    one = {"a.py": "12", "b.py": "34"}
    assert fingerprint(one) == fingerprint({"b.py": "34", "a.py": "12"})
    assert fingerprint(one) != fingerprint({"a.py": "12", "b.py": "35"})
    assert fingerprint(one) != fingerprint({"a.py": "12"})


PROBE = """
import json
from pack_lockstep.benchmarking.sources import Traced
result, used = Traced(abs, "blocks", "studies")(-3)
print(json.dumps([result, sorted(used)]))
"""


def test_work_and_what_makes_figures_of_it_count() -> None:
    answer = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True, check=True)
    result, used = json.loads(answer.stdout)
    assert result == 3
    assert "ros_ws/src/pack_evaluation/pack_evaluation/blocks/studies.py" in used
    for elsewhere in ("pack_bringup", "pack_viewer", "pallet_fsm", "pack_mpc"):
        assert not [path for path in used if elsewhere in path], elsewhere


def test_the_work_is_done_as_without_a_trace() -> None:
    result, sources = Traced(len, "packing", "studies")([1, 2])
    assert result == 2
    assert config_path("cells").is_dir()
    assert "ros_ws/src/pack_evaluation/pack_evaluation/packing/studies.py" in sources
