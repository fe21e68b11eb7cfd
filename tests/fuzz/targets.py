"""The readers of everything that comes from outside, each with sound files to begin with."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Sample:
    """A sound file: its content, and where in the project's folder the reader looks for it."""

    data: bytes
    path: str


@dataclass(frozen=True)
class Target:
    """A reader.

    Attributes:
        name: what it reads.
        kind: "yaml", "json" or "binary"; decides how its files are mutated.
        samples: makes the sound files; given an empty folder to work in.
        read: reads a file that is in place; raises PackError for one that must not be used.
    """

    name: str
    kind: str
    samples: Callable[[Path], Sequence[Sample]]
    read: Callable[[Path], Any]


def copy_config(root: Path) -> None:
    """Make `root` the project's folder of this process, with a copy of `config/` of its own."""
    shutil.copytree(ROOT / "config", root / "config")
    os.environ["PACKCELL_ROOT"] = str(root)


def _shipped(*patterns: str) -> Callable[[Path], list[Sample]]:
    def samples(_: Path) -> list[Sample]:
        paths = sorted(path for pattern in patterns for path in (ROOT / "config").glob(pattern))
        return [Sample(path.read_bytes(), str(path.relative_to(ROOT))) for path in paths]

    return samples


def _scenes(folder: Path) -> list[Sample]:
    from pack_core.packing.cell import packing_cell
    from pack_sim.packing.scene_generator import generate_scene

    generated = [generate_scene(seed, packing_cell()).to_yaml().encode() for seed in range(3)]
    return [
        *_shipped("scenarios/packing/*.yaml")(folder),
        *(Sample(text, "scene.yaml") for text in generated),
    ]


def _scene(path: Path) -> None:
    from pack_core.packing.scene_file import load_scene

    load_scene(path)


def _order(path: Path) -> None:
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import load_order

    load_order(path, palletizing_cell())


def _problems(folder: Path) -> list[Sample]:
    from pack_bringup.blocks.goal_command import problem_of

    generated = [problem_of(None, 9, 0.2, seed).encode() for seed in range(3)]
    return [
        *_shipped("scenarios/blocks/*.yaml")(folder),
        *(Sample(text, "problem.yaml") for text in generated),
    ]


def _problem(path: Path) -> None:
    from pack_bringup.blocks.goal_command import problem_of

    problem_of(path, 9, 0.2, 0)


def _records(_: Path) -> list[Sample]:
    from datetime import UTC, datetime

    from pack_bringup.recording.run_record import describe_run

    record = describe_run("packing", 3, "pack demo packing", datetime.now(UTC))
    folder = Path(os.environ["PACKCELL_ROOT"]) / "made"
    folder.mkdir()
    record.save(folder)
    short = b"cell: packing\nstarted: '2026-01-01T00:00:00'\nseed: 3\ncommand: x\ncommit: a\nversions: {}\n"
    return [Sample((folder / "run.yaml").read_bytes(), "run/run.yaml"), Sample(short, "run/run.yaml")]


def _record(path: Path) -> None:
    from pack_evaluation.record import about_the_run, cell_of, load_record

    about_the_run(load_record(path.parent))
    cell_of(path.parent)


def _nodes(path: Path) -> None:
    from pack_core.cells import CELLS

    cell = path.parent.name
    assert cell in CELLS
    if cell == "packing":
        from pack_lockstep.packing.lockstep_config import lockstep_config as packing

        packing()
    elif cell == "blocks":
        from pack_lockstep.blocks.settings import lockstep_config as blocks

        blocks()
    else:
        from pack_lockstep.palletizing.settings import set_up

        set_up(profile="blended", motion="shipped", preset="rigid", vision=True)


def _cells(path: Path) -> None:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.packing.cell import packing_cell
    from pack_core.palletizing.cell import palletizing_cell

    read = {"packing": packing_cell, "palletizing": palletizing_cell, "blocks": blocks_cell}[path.stem]
    read.cache_clear()
    read()


def _weights(path: Path) -> None:
    from pack_mpc.weights import load_weights

    getattr(load_weights, "__wrapped__", load_weights)(path.stem)


def _motion(path: Path) -> None:
    from pack_motion.tracking.config import motion_set

    getattr(motion_set, "__wrapped__", motion_set)(path.stem)


def _packing_list(path: Path) -> None:
    from pack_core.packing.cell import packing_cell
    from pack_core.packing.packing_list import load_list

    load_list(path, packing_cell())


def _object_set(path: Path) -> None:
    from pack_core.packing.object_set import load_set

    load_set.cache_clear()
    load_set(path.stem)


def _meshes(folder: Path) -> list[Sample]:
    import trimesh

    stl = trimesh.creation.box((60, 40, 90)).export(file_type="stl")
    return [*_shipped("object_sets/meshes/*.obj")(folder), Sample(stl, "box.stl")]


def _mesh(path: Path) -> None:
    from pack_core.errors import ConfigError
    from pack_core.packing.mesh_file import read_corners

    try:
        read_corners(path, 0.001)
    except ValueError as error:  # pydantic turns it into a refusal that names the key
        raise ConfigError(str(error)) from error


def _visitors(path: Path) -> None:
    from pack_core.palletizing.visitors import load_visitors

    getattr(load_visitors, "__wrapped__", load_visitors)(path.stem)


def _items(path: Path) -> None:
    from pack_core.palletizing.orders.item_list import load_items

    load_items(path)


def _presets(path: Path) -> None:
    from pack_bringup.packing.graph_preset import preset_overrides
    from pack_core.packing.cell import packing_cell

    packing_cell.cache_clear()
    preset_overrides(path.stem)


def _graphs(path: Path) -> None:
    from pack_bringup.graph.graph import launch_parameters, load_graph

    load_graph(path.stem).commands()
    launch_parameters(path.stem, "", [])


def _trials(_: Path) -> list[Sample]:
    from pack_lockstep.benchmarking.trial_file import TrialFile

    path = Path(os.environ["PACKCELL_ROOT"]) / "trials.jsonl"
    file = TrialFile(path, "packing", {"count": 3, "noise": {"a": 1.0}}, {"commit": "abc"})
    for k in range(3):
        file.add({"name": f"seed {k}", "placed": True, "time": 3.5})
    return [Sample(path.read_bytes(), "trials.jsonl")]


def _trial(path: Path) -> None:
    from pack_lockstep.benchmarking.trial_file import read_trials

    read_trials(path)


@cache
def _packing_bag() -> Path:
    from pack_bringup.recording import recorder
    from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter

    recorder.FLUSH_PERIOD = 1e-4  # many chunks
    folder = Path(os.environ["PACKCELL_ROOT"]) / "recorded"
    writer = GoalWriter(folder)
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    return folder


def _bags(_: Path) -> list[Sample]:
    return [Sample((_packing_bag() / "bag" / "bag.mcap").read_bytes(), "alone/bag.mcap")]


def _bag_folders(_: Path) -> list[Sample]:
    folder, root = _packing_bag() / "bag", Path(os.environ["PACKCELL_ROOT"])
    return [
        Sample(folder.joinpath("metadata.yaml").read_bytes(), str(folder.relative_to(root) / "metadata.yaml"))
    ]


def _bag(path: Path) -> None:
    from pack_evaluation.packing.from_bag import load_run

    load_run(path if path.suffix == ".mcap" else path.parent)


def _saved_runs(_: Path) -> list[Sample]:
    from pack_evaluation.packing.from_bag import load_run
    from pack_evaluation.packing.run_file import save_run

    path = Path(os.environ["PACKCELL_ROOT"]) / "run.npz"
    save_run(load_run(_packing_bag()), path)
    return [Sample(path.read_bytes(), "run.npz")]


def _saved_run(path: Path) -> None:
    from pack_evaluation.packing.run_file import load_saved_run

    load_saved_run(path)


def _upload(path: Path) -> None:
    from pack_core.packing.scene_file import parse_scene
    from pack_core.text.reader import decoded

    parse_scene(decoded(path.read_bytes(), path.name), path.name)


def _tags(path: Path) -> None:
    from pack_core.blocks.tags_text import parse_tags

    parse_tags(_received(path))


def _described(path: Path) -> None:
    from pack_core.packing.scene import Scene

    Scene.from_yaml(_received(path), "/cell_description")


def _boxes(path: Path) -> None:
    from pack_viewer.palletizing.pallet_scene import boxes_in

    boxes_in(_received(path))


def _received(path: Path) -> str:
    """The text as a message would bring it, whose strings are always valid UTF-8."""
    return path.read_bytes().decode("utf-8", "replace").replace("\x00", "")


def _one(text: str, name: str) -> Callable[[Path], list[Sample]]:
    return lambda _: [Sample(text.encode(), name)]


ITEMS = "article,length,width,height,weight,quantity\na,0.4,0.3,0.2,5,3\nb,0.3,0.2,0.15,2.5,2\n"
TAGS = "tags: {red: 0, blue_block: 1, c: 2}\n"
BOXES = "- {name: a-1, size: [0.3, 0.2, 0.2], mass: 4.0}\n- {name: b-2, size: [0.3, 0.2, 0.2], mass: 2.5}\n"

TARGETS = (
    Target("scene", "yaml", _scenes, _scene),
    Target("order", "json", _shipped("orders/*.json"), _order),
    Target("blocks problem", "yaml", _problems, _problem),
    Target("run.yaml", "yaml", _records, _record),
    Target("node parameters", "yaml", _shipped("nodes/*/*.yaml"), _nodes),
    Target("cells", "yaml", _shipped("cells/*.yaml"), _cells),
    Target("weights", "yaml", _shipped("weights/*.yaml"), _weights),
    Target("motion", "yaml", _shipped("motion/*.yaml"), _motion),
    Target("packing list", "yaml", _shipped("packing_lists/*.yaml"), _packing_list),
    Target("object set", "yaml", _shipped("object_sets/*.yaml"), _object_set),
    Target("mesh", "binary", _meshes, _mesh),
    Target("visitors", "yaml", _shipped("visitors/*.yaml"), _visitors),
    Target("list of boxes", "binary", _one(ITEMS, "items.csv"), _items),
    Target("presets", "yaml", _shipped("presets/*.yaml"), _presets),
    Target("graphs", "yaml", _shipped("graphs/*.yaml"), _graphs),
    Target("trials", "binary", _trials, _trial),
    Target("bag file", "binary", _bags, _bag),
    Target("metadata of a bag", "yaml", _bag_folders, _bag),
    Target("saved run", "binary", _saved_runs, _saved_run),
    Target("uploaded scene", "yaml", _scenes, _upload),
    Target("message: cell", "yaml", _scenes, _described),
    Target("message: tags", "yaml", _one(TAGS, "tags.yaml"), _tags),
    Target("message: boxes", "yaml", _one(BOXES, "boxes.yaml"), _boxes),
)
"""All readers."""
