"""A packing run as one `.npz` file, which lockstep saves for every scene."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pack_core.errors import BagError
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.packing.settled_sample import SettledSample
from pack_core.rotations import Pose
from pack_evaluation.packing.run import Iterations, Run, SeenObject, SeenScene
from pack_evaluation.track import Track

LARGEST = 500e6
"""Of all arrays of a run, unpacked; a run of a minute has some megabytes [byte]."""
SUFFIX = ".npz"
TRACKS = ("truth", "estimate")
TEXTS = ("stages", "collisions")
ABOUT, SAMPLES = "about", "samples"
DEFAULT_ARM = "panda"
ARRAYS = ("joint_times", "joints", "force_times", "force", "real_time_factors")


def save_run(run: Run, path: Path) -> None:
    """Write the run, compressed; the file appears whole or not at all."""
    about = {
        "scene": run.scene.to_yaml(), "start": run.start, "end": run.end, "outcome": run.outcome,
        "release_reason": run.release_reason, "is_cut": run.is_cut, "arm": run.arm,
        "seen": _plain_seen(run.seen), "seen_after": _plain_seen(run.seen_after),
        **{name: getattr(run.iterations, name) for name in TEXTS},
    }  # fmt: skip
    arrays: dict[str, Any] = {ABOUT: np.array(json.dumps(about)), **dict(_arrays(run))}
    arrays[SAMPLES] = np.array(json.dumps([_plain(sample) for sample in run.samples]))
    part = path.with_name(f".{path.name}")
    with part.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    part.replace(path)


def load_saved_run(path: Path) -> Run:
    """Read what `save_run` wrote.

    Raises:
        BagError: the file is missing, broken, or something else.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            if (size := sum(item.file_size for item in packed.infolist())) > LARGEST:
                raise ValueError(f"it unpacks to {size / 1e6:.0f} MB; allowed: {LARGEST / 1e6:.0f} MB")
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(str(arrays.pop(ABOUT)))
        return _run(about, arrays)
    except (
        Exception
    ) as error:  # damaged bytes: errors of zip, zlib, NumPy's header parser, JSON and the scene
        raise BagError(f"{path} is no run as `pack benchmark` saves it: {error}") from error


def _arrays(run: Run) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    for kind in TRACKS:
        for name, track in getattr(run, kind).items():
            for field in fields(Track):
                yield f"{kind}/{name}/{field.name}", getattr(track, field.name)
    for field in fields(Iterations):
        if field.name not in TEXTS:
            yield f"iterations/{field.name}", getattr(run.iterations, field.name)
    for name in ARRAYS:
        yield name, getattr(run, name)


def _run(about: dict[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> Run:
    scene = Scene.from_yaml(about["scene"])
    names = [*scene.names, scene.new_object.name]
    iterations = Iterations(
        stages=tuple(about["stages"]), collisions=tuple(tuple(item) for item in about["collisions"]),
        **_below("iterations", Iterations, arrays),
    )  # fmt: skip
    truth, estimate = (_tracks(kind, names, arrays) for kind in TRACKS)
    given: dict[str, Any] = {name: arrays[name] for name in ARRAYS}
    return Run(
        scene=scene, start=about["start"], end=about["end"], iterations=iterations, truth=truth,
        estimate=estimate, release_reason=about["release_reason"], outcome=about["outcome"],
        is_cut=about["is_cut"],
        arm=about.get("arm", DEFAULT_ARM),  # files from before there was a second arm do not name it
        # files from before samples were kept have none
        samples=tuple(_sample(given) for given in json.loads(str(arrays.get(SAMPLES, "[]")))),
        # older files do not have them
        seen=_seen(about.get("seen")), seen_after=_seen(about.get("seen_after")),
        **given,
    )  # fmt: skip


def _seen(given: dict[str, Any] | None) -> SeenScene | None:
    if given is None:
        return None
    objects = {name: _seen_object(item) for name, item in given["objects"].items()}
    # files from before looks told how sure they were do not have it
    told = given.get("deviations", {})
    deviations = {name: SeenDeviations.model_validate(item) for name, item in told.items()}
    held = None if given.get("held") is None else _seen_object(given["held"])
    return SeenScene(Scene.from_yaml(given["scene"]), _poses(given["poses"]), objects, deviations, held)


def _seen_object(given: Mapping[str, Any]) -> SeenObject:
    return SeenObject(**{**given, "sizes": tuple(given["sizes"])})


def _plain_seen(seen: SeenScene | None) -> dict[str, Any] | None:
    if seen is None:
        return None
    objects = {name: asdict(item) for name, item in seen.objects.items()}
    deviations = {name: item.model_dump(mode="json") for name, item in seen.deviations.items()}
    return {
        "scene": seen.scene.to_yaml(), "poses": _rows(seen.poses), "objects": objects,
        "deviations": deviations, "held": None if seen.held is None else asdict(seen.held),
    }  # fmt: skip


def _plain(sample: SettledSample) -> dict[str, Any]:
    """The sample's fields, each pose as a list of position and quaternion."""
    return {**vars(sample), "poses": _rows(sample.poses)}


def _sample(given: dict[str, Any]) -> SettledSample:
    """The sample that `_plain` wrote."""
    return SettledSample(**{**given, "poses": _poses(given["poses"])})


def _rows(poses: Mapping[str, Pose]) -> dict[str, list[float]]:
    return {name: [*X_WO.p.tolist(), *X_WO.q.tolist()] for name, X_WO in poses.items()}


def _poses(rows: Mapping[str, list[float]]) -> dict[str, Pose]:
    return {name: Pose(np.array(row[:3]), np.array(row[3:])) for name, row in rows.items()}


def _tracks(kind: str, names: list[str], arrays: Mapping[str, npt.NDArray[Any]]) -> dict[str, Track]:
    there = [name for name in names if f"{kind}/{name}/times" in arrays]
    return {name: Track(**_below(f"{kind}/{name}", Track, arrays)) for name in there}


def _below(prefix: str, cls: type[Any], arrays: Mapping[str, npt.NDArray[Any]]) -> dict[str, Any]:
    """The arrays below a prefix that are fields of a class, by field."""
    return {field.name: arrays[f"{prefix}/{field.name}"] for field in fields(cls) if field.name not in TEXTS}
