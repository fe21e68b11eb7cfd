"""What the published results were, version by version."""

from pathlib import Path

from pack_lockstep.results.history import append, read, write_plot

FIRST = {
    "date": "2026-01-02",
    "version": "1.0.0",
    "commit": "1a2b",
    "name": "packing/ideal",
    "success": 98,
    "of": 100,
}


def test_lines_are_added_and_read_back(tmp_path: Path) -> None:
    assert read(tmp_path) == []
    append(tmp_path, {**FIRST, "time_s": 3.34219, "force_N": None})
    append(tmp_path, {**FIRST, "version": "1.1.0", "success": 100})
    rows = read(tmp_path)
    assert [(row["version"], row["success"], row["time_s"], row["force_N"]) for row in rows] == [
        ("1.0.0", "98", "3.342", ""),
        ("1.1.0", "100", "", ""),
    ]
    assert (tmp_path / "history.csv").read_text().count("date,version") == 1


def test_the_plot_shows_every_cell(tmp_path: Path) -> None:
    for version in ("1.0.0", "1.1.0"):
        append(tmp_path, {**FIRST, "version": version, "time_s": 3.0})
        append(tmp_path, {**FIRST, "version": version, "name": "blocks/plans"})
    write_plot(tmp_path, tmp_path / "plots" / "history.png")
    assert (tmp_path / "plots" / "history.png").read_bytes().startswith(b"\x89PNG")
