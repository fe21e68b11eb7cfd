"""tools/env.sh in a shell that has sourced another checkout before."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]


def checkout(folder: Path) -> Path:
    """A folder with env.sh and all that it sources."""
    (folder / "tools").mkdir(parents=True)
    shutil.copy(ROOT / "tools" / "env.sh", folder / "tools")
    for path in (".venv/bin/activate", ".venv/local_setup.bash", "ros_ws/install/local_setup.bash"):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text("")
    return folder


def sourced(folder: Path, **environment: str) -> dict[str, str]:
    """The environment once env.sh of a checkout has been sourced."""
    outside = {"PATH": os.environ["PATH"], **environment}
    done = subprocess.run(
        ["bash", "-c", "source tools/env.sh && env -0"],
        cwd=folder, env=outside, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return dict(line.split("=", 1) for line in done.stdout.split("\0") if line)


def test_what_another_checkout_put_on_the_paths_is_dropped(tmp_path: Path) -> None:
    other, own = checkout(tmp_path / "other one"), checkout(tmp_path / "own")
    foreign = [other / "ros_ws" / "install" / "pack_core", other / ".venv" / "lib", other / ".venv"]
    kept = [own / "ros_ws" / "install" / "pack_core", own / ".venv" / "lib", Path("/opt/else/lib"), tmp_path]
    path = ":".join(map(str, [foreign[0], kept[0], foreign[1], kept[1], foreign[2], *kept[2:]]))
    names = ("PYTHONPATH", "LD_LIBRARY_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")
    found = sourced(own, **dict.fromkeys(names, path))
    for name in names:
        assert found[name] == ":".join(map(str, kept)), name


def test_a_clean_shell_gets_no_paths_but_what_is_sourced(tmp_path: Path) -> None:
    found = sourced(checkout(tmp_path / "own"))
    assert not [name for name in found if name.endswith("PYTHONPATH") or name == "LD_LIBRARY_PATH"]
    assert found["PACKCELL_ROOT"] == str(tmp_path / "own")


def test_what_is_set_stays(tmp_path: Path) -> None:
    own = checkout(tmp_path / "own")
    assert sourced(own)["OPENBLAS_NUM_THREADS"] == "1"
    assert sourced(own, OPENBLAS_NUM_THREADS="4")["OPENBLAS_NUM_THREADS"] == "4"
