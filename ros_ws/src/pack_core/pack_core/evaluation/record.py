"""What a run was made with: run.yaml in its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

RECORD = "run.yaml"


def load_record(recording: Path) -> dict[str, Any]:
    """What run.yaml holds in the run's folder or, of a bag, beside it; empty where there is none."""
    for folder in (recording, recording.parent):
        if (folder / RECORD).is_file():
            return dict(yaml.safe_load((folder / RECORD).read_text()))
    return {}
