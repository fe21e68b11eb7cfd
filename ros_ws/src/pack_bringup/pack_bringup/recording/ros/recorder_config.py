"""Parameters of the recorder, and what follows from them before the first message."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

from pydantic import Field

from pack_bringup.recording.message_types import message_types
from pack_bringup.recording.record import Record
from pack_bringup.recording.recorder import Recorder
from pack_bringup.recording.ros.bag_topics import to_bag_topic
from pack_bringup.recording.run_record import BAG_FOLDER, default_folder, describe_run
from pack_core.config import Config
from pack_core.errors import BagError
from pack_core.ros.contracts.table import recorded


class RecorderConfig(Config):
    """Parameters of the recorder."""

    path: str = Field(default="", description="the run's folder; empty: bags/<cell>_<date>_seed<seed>")
    cell: str = Field(default="packing", description="the cell whose topics are recorded")
    record: Record = Field(default="goals", description="when to record: while goals run, always, or never")
    split_mb: float = Field(default=24.0, gt=0.0, description="size at which another file is begun [MB]")
    limit_gb: float = Field(default=10.0, gt=0.0, description="size of the bag at which recording ends [GB]")
    required: bool = Field(
        default=False, description="end the node, and so the goal in progress, when recording fails"
    )
    seed: int | None = Field(default=None, description="the run's seed, for run.yaml")
    preset: str = Field(default="", description="the conditions' name, for run.yaml")
    command: str = Field(default="", description="the command line that started the run, for run.yaml")


def begin_recording(config: RecorderConfig) -> tuple[Path, Recorder]:
    """The run's folder with its description, and the bag in it, open.

    Raises:
        BagError: it cannot be made or written.
    """
    now = datetime.now()
    folder = Path(config.path) if config.path else default_folder(config.cell, config.seed, now)
    recorder = Recorder(
        folder / BAG_FOLDER, map(to_bag_topic, recorded(config.cell)), message_types(),
        split_size=config.split_mb * 1e6, limit=config.limit_gb * 1e9,
    )  # fmt: skip
    try:
        describe_run(config.cell, config.seed, config.command, now, config.preset).save(folder)
    except OSError as error:
        recorder.close()
        raise BagError(f"cannot record to {folder}: {error}; give another `path`") from error
    return folder, recorder


def recording_plan(config: RecorderConfig) -> str:
    """What is recorded, and how far, in the words of the log."""
    what = "all that is sent" if config.record == "always" else "goals, from 2 s before to 2 s after each,"
    return (
        f"{what} in compressed files of {config.split_mb:g} MB, at most {config.limit_gb:g} GB together "
        "(limit_gb; then recording stops and the cell goes on)"
    )
