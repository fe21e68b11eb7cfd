"""Whether a published result is one of the code that is here."""

from dataclasses import replace
from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_lockstep.results.published import PublishedResult, ResultState, load_result

PACKAGES = {"packcell": "1.0.0", "mujoco": "4.0.0", "numpy": "2.4.6", "scipy": "1.17.1", "numba": "0.68.1"}
COMMAND = "pack benchmark packing --scenes 100"
RESULT = PublishedResult(
    command=COMMAND, date="2026-01-02", version="1.0.0", commit="1a2b3c", machine="two cores",
    packages=PACKAGES, summary={"scenes": 100, "success": 99}, sources={"a.py": "12", "b.yaml": "34"},
)  # fmt: skip


def standing(result: PublishedResult, command: str = COMMAND, **packages: str) -> tuple[ResultState, str]:
    found = result.standing(command, PACKAGES | packages, lambda _: {"a.py": "12", "b.yaml": "34"})
    return found.state, found.reason


def test_a_result_of_the_same_sources_packages_and_command_is_valid() -> None:
    assert standing(RESULT) == (ResultState.VALID, "")
    assert standing(RESULT, packcell="1.1.0") == (ResultState.VALID, "")


def test_a_package_that_was_not_noted_then_is_not_taken_for_another_one() -> None:
    assert standing(RESULT, ruckig="0.19") == (ResultState.VALID, "")
    noted = replace(RESULT, packages={**PACKAGES, "ruckig": "0.18"})
    assert standing(noted, ruckig="0.19") == (ResultState.STALE, "ruckig 0.18 was installed, now 0.19")


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"sources": {"a.py": "12", "b.yaml": "35"}}, "b.yaml changed"),
        ({"sources": {"a.py": "13", "b.yaml": "35"}}, "a.py and 1 more changed"),
        ({"sources": {}}, "version 1.0.0 kept no fingerprint"),
        ({"command": "pack benchmark packing"}, "the command was: pack benchmark packing"),
        ({"packages": {**PACKAGES, "numpy": "2.5"}}, "numpy 2.5 was installed, now 2.4.6"),
    ],
)
def test_a_stale_result_says_why(change: dict[str, object], reason: str) -> None:
    assert standing(replace(RESULT, **change)) == (ResultState.STALE, reason)


def test_a_file_gives_back_what_was_saved(tmp_path: Path) -> None:
    path = tmp_path / "packing" / "ideal.json"
    assert load_result(path) is None
    RESULT.save(path)
    assert load_result(path) == RESULT
    assert '"fingerprint": "' in path.read_text()
    assert [file.name for file in path.parent.iterdir()] == ["ideal.json"]


def test_a_file_of_something_else_is_refused_with_what_it_lacks(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"command": "pack"}')
    with pytest.raises(ConfigError, match=r"a\.json is no published result: it lacks 'date'"):
        load_result(tmp_path / "a.json")
