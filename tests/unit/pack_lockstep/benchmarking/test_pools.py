import math
import os
import select
import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.errors import ConfigError, PackError
from pack_core.packing.scene_file import load_scene
from pack_lockstep.benchmarking.pools import SINGLE_THREADED, LocalPool, open_pool

MISSING = Path("no_such_scene.yaml")
"""`load_scene` of it raises ConfigError."""
ENDLESS = """
import os, signal
from pathlib import Path

def work(pipe):
    Path(pipe).write_text(str(os.getpid()))
    signal.pause()
"""
"""Says the number of the process that a job runs in."""
SCRIPT = """
import sys
from endless import work
from pack_lockstep.benchmarking.pools import LocalPool

list(LocalPool(1).run(work, sys.argv[1:]))
"""
"""Has no guard against being imported: processes that it starts must not."""


def test_every_job_comes_back_once_whatever_the_order() -> None:
    assert sorted(LocalPool(2).run(math.factorial, range(6))) == [1, 1, 2, 6, 24, 120]


def test_libraries_of_the_jobs_have_one_thread_and_this_process_keeps_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    with open_pool(1, None, 1) as pool:
        assert list(pool.run(os.getenv, SINGLE_THREADED)) == list(SINGLE_THREADED.values())
    assert "OMP_NUM_THREADS" not in os.environ


def test_an_error_of_a_job_is_raised_here_with_its_words() -> None:
    with pytest.raises(ConfigError, match=r"no_such_scene\.yaml"):
        list(LocalPool(1).run(load_scene, [MISSING]))


def test_the_death_of_a_process_is_an_error_not_a_wait() -> None:
    with pytest.raises(PackError, match="process died"):
        list(LocalPool(1).run(os._exit, [1]))


def test_processes_end_when_the_one_that_started_them_is_killed(tmp_path: Path) -> None:
    script, pipe = tmp_path / "script.py", tmp_path / "pipe"
    (tmp_path / "endless.py").write_text(ENDLESS)
    script.write_text(SCRIPT)
    os.mkfifo(pipe)
    with subprocess.Popen([sys.executable, str(script), str(pipe)]) as parent:
        worker = os.pidfd_open(int(pipe.read_text()))
        parent.kill()
    ended, _, _ = select.select([worker], [], [], 30.0)
    assert ended


def test_ray_that_is_not_installed_is_an_error_that_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(PackError, match=r"uv pip install .*cluster"), open_pool(1, "auto", 1):
        pass


def test_a_ray_cluster_gives_what_processes_give() -> None:
    pytest.importorskip("ray", reason="Ray is an extra: requirements/cluster.txt")
    with open_pool(2, "local", 1) as pool:
        assert sorted(pool.run(math.factorial, range(6))) == [1, 1, 2, 6, 24, 120]
        assert list(pool.run(os.getenv, SINGLE_THREADED)) == list(SINGLE_THREADED.values())
        with pytest.raises(ConfigError, match=r"no_such_scene\.yaml"):
            list(pool.run(load_scene, [MISSING]))
