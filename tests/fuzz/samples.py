"""Sound files of everything that comes from outside, to begin with."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Sample:
    """A sound file: its content, and where in the project's folder the reader looks for it."""

    data: bytes
    path: str


def copy_config(root: Path) -> None:
    """Make `root` the project's folder of this process, with a copy of `config/` of its own."""
    shutil.copytree(ROOT / "config", root / "config")
    os.environ["PACKCELL_ROOT"] = str(root)


def shipped(*patterns: str) -> Callable[[Path], list[Sample]]:
    """Files of config/."""

    def found(_: Path) -> list[Sample]:
        paths = sorted(path for pattern in patterns for path in (ROOT / "config").glob(pattern))
        return [Sample(path.read_bytes(), str(path.relative_to(ROOT))) for path in paths]

    return found


def scenes(folder: Path) -> list[Sample]:
    """Scene files: those that are shipped, and generated ones."""
    from pack_core.packing.cell import packing_cell
    from pack_sim.packing.scene_generator import generate_scene

    generated = [generate_scene(seed, packing_cell()).to_yaml().encode() for seed in range(3)]
    return [
        *shipped("scenarios/packing/*.yaml")(folder),
        *(Sample(text, "scene.yaml") for text in generated),
    ]


def sent_scenes(folder: Path) -> list[Sample]:
    """Scenes as they are uploaded or sent: with the corners of meshes in the place of their files."""
    from pack_core.packing.scene_file import scene_text

    paths = sorted((ROOT / "config" / "scenarios" / "packing").glob("*.yaml"))
    return [
        *(Sample(scene_text(path).encode(), path.name) for path in paths),
        *(sample for sample in scenes(folder) if sample.path == "scene.yaml"),
    ]


def problems(folder: Path) -> list[Sample]:
    """Problem files of the blocks cell."""
    from pack_bringup.blocks.commands import problem_of

    generated = [problem_of(None, 9, 0.2, seed).encode() for seed in range(3)]
    return [
        *shipped("scenarios/blocks/*.yaml")(folder),
        *(Sample(text, "problem.yaml") for text in generated),
    ]


def records(_: Path) -> list[Sample]:
    """The run.yaml of a recording, with all keys and with few."""
    from datetime import UTC, datetime

    from pack_bringup.recording.run_record import describe_run

    record = describe_run("packing", 3, "pack demo packing", datetime.now(UTC))
    folder = Path(os.environ["PACKCELL_ROOT"]) / "made"
    folder.mkdir()
    record.save(folder)
    short = b"cell: packing\nstarted: '2026-01-01T00:00:00'\nseed: 3\ncommand: x\ncommit: a\nversions: {}\n"
    return [Sample((folder / "run.yaml").read_bytes(), "run/run.yaml"), Sample(short, "run/run.yaml")]


def meshes(folder: Path) -> list[Sample]:
    """Meshes of objects, as text and binary."""
    import trimesh

    stl = trimesh.creation.box((60, 40, 90)).export(file_type="stl")
    return [*shipped("object_sets/meshes/*.obj")(folder), Sample(stl, "box.stl")]


def trials(_: Path) -> list[Sample]:
    """Results of a benchmark."""
    from pack_lockstep.benchmarking.results_folder import TrialFile

    path = Path(os.environ["PACKCELL_ROOT"]) / "trials.jsonl"
    file = TrialFile(path, "packing", {"count": 3, "noise": {"a": 1.0}}, {"commit": "abc"})
    for k in range(3):
        file.add({"name": f"seed {k}", "placed": True, "time": 3.5})
    return [Sample(path.read_bytes(), "trials.jsonl")]


@cache
def packing_bag() -> Path:
    """The folder of a recorded goal, in many chunks."""
    from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter

    folder = Path(os.environ["PACKCELL_ROOT"]) / "recorded"
    writer = GoalWriter(folder, chunk=20)
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    return folder


def bags(_: Path) -> list[Sample]:
    """The file of a bag, alone."""
    return [Sample((packing_bag() / "bag" / "bag.mcap").read_bytes(), "alone/bag.mcap")]


def bag_folders(_: Path) -> list[Sample]:
    """The metadata of a bag, beside its file."""
    folder, root = packing_bag() / "bag", Path(os.environ["PACKCELL_ROOT"])
    return [
        Sample(folder.joinpath("metadata.yaml").read_bytes(), str(folder.relative_to(root) / "metadata.yaml"))
    ]


def saved_runs(_: Path) -> list[Sample]:
    """A run as arrays."""
    from pack_evaluation.packing.from_bag import load_run
    from pack_evaluation.packing.run_file import save_run

    path = Path(os.environ["PACKCELL_ROOT"]) / "run.npz"
    save_run(load_run(packing_bag()), path)
    return [Sample(path.read_bytes(), "run.npz")]


def one(text: str, name: str) -> Callable[[Path], list[Sample]]:
    """A text as a file of its own."""
    return lambda _: [Sample(text.encode(), name)]
