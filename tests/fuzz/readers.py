"""What reads everything that comes from outside: each raises PackError for what must not be used."""

from __future__ import annotations

from pathlib import Path


def scene(path: Path) -> None:
    """A scene file of the packing cell."""
    from pack_core.packing.scene_file import load_scene

    load_scene(path)


def order(path: Path) -> None:
    """An order of the palletizing cell."""
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import load_order

    load_order(path, palletizing_cell())


def problem(path: Path) -> None:
    """A problem file of the blocks cell."""
    from pack_bringup.blocks.commands import problem_of

    problem_of(path, 9, 0.2, 0)


def record(path: Path) -> None:
    """The run.yaml of a recording."""
    from pack_evaluation.record import about_the_run, cell_of, load_record

    about_the_run(load_record(path.parent))
    cell_of(path.parent)


def nodes(path: Path) -> None:
    """Parameters of a cell's nodes."""
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

        set_up()


def cells(path: Path) -> None:
    """The facts of a cell."""
    from pack_core.blocks.cell import blocks_cell
    from pack_core.packing.cell import packing_cell
    from pack_core.palletizing.cell import palletizing_cell

    read = {"packing": packing_cell, "palletizing": palletizing_cell, "blocks": blocks_cell}[path.stem]
    read.cache_clear()
    read()


def weights(path: Path) -> None:
    """A set of weights."""
    from pack_mpc.cost.weights import load_weights

    getattr(load_weights, "__wrapped__", load_weights)(path.stem)


def motion(path: Path) -> None:
    """A set of motion parameters."""
    from pack_motion.tracking.config import motion_set

    getattr(motion_set, "__wrapped__", motion_set)(path.stem)


def packing_list(path: Path) -> None:
    """A list of objects."""
    from pack_core.packing.cell import packing_cell
    from pack_core.packing.packing_list import load_list

    load_list(path, packing_cell())


def object_set(path: Path) -> None:
    """A set of objects."""
    from pack_core.packing.object_set import load_set

    load_set.cache_clear()
    load_set(path.stem)


def mesh(path: Path) -> None:
    """A mesh of an object."""
    from pack_core.errors import ConfigError
    from pack_core.packing.mesh_file import read_corners

    try:
        read_corners(path, 0.001)
    except ValueError as error:  # pydantic turns it into a refusal that names the key
        raise ConfigError(str(error)) from error


def visitors(path: Path) -> None:
    """Visitors of the palletizing cell."""
    from pack_core.palletizing.visitors import load_visitors

    getattr(load_visitors, "__wrapped__", load_visitors)(path.stem)


def items(path: Path) -> None:
    """A list of boxes."""
    from pack_core.palletizing.orders.item_list import load_items

    load_items(path)


def presets(path: Path) -> None:
    """Conditions."""
    from pack_bringup.packing.goals import preset_overrides
    from pack_core.packing.cell import packing_cell

    packing_cell.cache_clear()
    preset_overrides(path.stem)


def graphs(path: Path) -> None:
    """The nodes of a cell."""
    from pack_bringup.graph.graph import load_graph
    from pack_bringup.graph.launch import launch_parameters

    load_graph(path.stem).commands()
    launch_parameters(path.stem, "", [])


def trial(path: Path) -> None:
    """Results of a benchmark."""
    from pack_lockstep.benchmarking.results_folder import read_trials

    read_trials(path)


def bag(path: Path) -> None:
    """A bag's file, or its metadata."""
    from pack_evaluation.packing.from_bag import load_run

    load_run(path if path.suffix == ".mcap" else path.parent)


def saved_run(path: Path) -> None:
    """A run as arrays."""
    from pack_evaluation.packing.run_file import load_saved_run

    load_saved_run(path)


def upload(path: Path) -> None:
    """A scene file that a browser has uploaded."""
    from pack_core.packing.scene_file import parse_scene
    from pack_core.text.reader import decoded

    parse_scene(decoded(path.read_bytes(), path.name), path.name)


def tags(path: Path) -> None:
    """A message of the tags' numbers."""
    from pack_core.blocks.block_sighting import parse_tags

    parse_tags(_received(path))


def described(path: Path) -> None:
    """A message that describes the packing cell."""
    from pack_core.packing.scene import Scene

    Scene.from_yaml(_received(path), "/cell_description")


def boxes(path: Path) -> None:
    """A message that lists boxes."""
    from pack_viewer.palletizing.pallet_scene import boxes_in

    boxes_in(_received(path))


def _received(path: Path) -> str:
    """The text as a message would bring it, whose strings are always valid UTF-8."""
    return path.read_bytes().decode("utf-8", "replace").replace("\x00", "")
