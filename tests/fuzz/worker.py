"""Reads mutated files in a process of its own, of limited memory, and says how each reading ended."""

from __future__ import annotations

import random
import resource
import time
import traceback
import zlib
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory

from fuzz.mutations import mutated
from fuzz.samples import Sample, copy_config
from fuzz.targets import TARGETS, Target

MOST_MEMORY = 500e6
"""Address space that a reading may take beyond what the process has after a sound file [byte]."""
READY = "ready"
ERROR, ACCEPTED, TRACEBACK, MEMORY = "clear error", "accepted", "traceback", "> 500 MB"


@dataclass(frozen=True)
class Reading:
    """How one reading ended, its processor time [s], and the cause of a traceback."""

    outcome: str
    seconds: float
    cause: str = ""


def work(connection: Connection, name: str) -> None:
    """Serve numbers of inputs of one target until the other end closes."""
    target = next(item for item in TARGETS if item.name == name)
    with TemporaryDirectory(prefix="fuzz_") as folder:
        root = Path(folder)
        copy_config(root)
        samples = list(target.samples(root))
        for sample in samples:  # all, so that every module is imported before anything is timed
            put(sample, sample.data, root)
            target.read(root / sample.path)  # a sound file must be read without an error
        _limit_memory()
        connection.send(READY)
        while True:
            try:
                number = connection.recv()
            except EOFError:
                return
            connection.send(_read(target, samples, number, root))


def make_input(target: Target, samples: list[Sample], number: int) -> tuple[Sample, bytes]:
    """Input `number` of a target: the same in every process."""
    rng = random.Random(zlib.crc32(target.name.encode()) * 1_000_003 + number)
    sample = rng.choice(samples)
    return sample, mutated(sample.data, target.kind, rng)


def put(sample: Sample, data: bytes, root: Path) -> None:
    """Write a file where its reader looks for it."""
    path = root / sample.path
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def _read(target: Target, samples: list[Sample], number: int, root: Path) -> Reading:
    from pack_core.errors import PackError

    sample, data = make_input(target, samples, number)
    put(sample, data, root)
    start, cause = time.process_time(), ""
    try:
        target.read(root / sample.path)
        outcome = ACCEPTED
    except PackError as error:
        outcome, cause = ERROR, str(error)
    except MemoryError:
        outcome = MEMORY
    except BaseException as error:
        outcome, cause = TRACEBACK, _cause(error)
    seconds = time.process_time() - start
    put(sample, sample.data, root)  # files of one folder are read together
    return Reading(outcome, seconds, cause)


def _cause(error: BaseException) -> str:
    own = [frame for frame in traceback.extract_tb(error.__traceback__) if "/pack_" in frame.filename]
    place = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else "?"
    return f"{type(error).__name__} at {place}: {str(error)[:80]}"


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = int(pages * resource.getpagesize() + MOST_MEMORY)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
