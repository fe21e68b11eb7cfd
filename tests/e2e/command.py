"""The `pack` command as a process, with small videos, and what it leaves behind."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from integration.harness import own_domain

# A background job of a shell ignores Ctrl-C, and so would what it starts.
PACK = ["env", "--default-signal=INT", sys.executable, "-m", "e2e.small_videos"]
TESTS = Path(__file__).parents[1]


def pack(*arguments: str | Path) -> subprocess.Popen[str]:
    """Start the command in a domain of this test worker; errors come with the output.

    Left to itself the command takes a domain that looks free, and so may another worker's in that moment.
    """
    environment = {**os.environ, "ROS_DOMAIN_ID": str(own_domain())}
    environment["PYTHONPATH"] = f"{TESTS}{os.pathsep}{environment.get('PYTHONPATH', '')}"
    return subprocess.Popen(
        [*PACK, *map(str, arguments)], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env=environment,
    )  # fmt: skip


def output_of(process: subprocess.Popen[str]) -> str:
    """All that a process prints until it ends."""
    assert process.stdout is not None
    text = process.stdout.read()
    process.wait()
    return text


def measured_again(run: Path, output: Path) -> dict[str, Any]:
    """What `pack evaluate` measures of a run's recording; its report goes into the folder `output`."""
    measures = output / "m.json"
    process = pack("evaluate", run, "--no-video", "--json", measures, "--output", output)
    text = output_of(process)
    assert process.returncode == 0, text
    found: dict[str, Any] = json.loads(measures.read_text())
    return found


def alarms(folder: Path) -> list[str]:
    """Lines of a run's log that would alarm somebody: errors, tracebacks, what could not be logged."""
    lines = (folder / "nodes.log").read_text().splitlines()
    return [line for line in lines if re.search(r"ERROR|FATAL|Traceback|Failed to|error:", line)]
