"""Processor time that a process has used."""

from __future__ import annotations

import os
import re
from pathlib import Path


def processor_time(pid: int) -> float:
    """User and system time of a process and all its threads [s]; proc(5) has the fields of this file."""
    fields = re.sub(r"^.*\) ", "", Path(f"/proc/{pid}/stat").read_text()).split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
