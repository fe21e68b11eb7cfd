"""README and `make help` say how long the first steps take."""

import subprocess

from pack_core.paths import project_root


def test_readme_says_how_long_each_first_step_takes() -> None:
    lines = (project_root() / "README.md").read_text().splitlines()
    steps = ("`make demo` the first time", "`make demo` again", "`make test`", "=palletizing`", "=blocks`")
    for step in steps:
        assert any(step in line and "minute" in line for line in lines), step


def test_make_help_fits_80_columns_and_says_how_long_a_demo_takes() -> None:
    said = subprocess.run(["make", "help"], cwd=project_root(), capture_output=True, text=True).stdout
    assert "minutes the first time" in said
    assert max(map(len, said.splitlines())) <= 80
