"""The problems of a benchmark: generated ones, and those of files."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Protocol

from pack_core.blocks.cell import BlocksCell, blocks_cell
from pack_core.blocks.problem import Problem
from pack_core.blocks.problem_file import parse_problem
from pack_core.errors import ConfigError
from pack_core.text.reader import read_text
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.validation import find_fault

WARM_UP_SEED = 10**6
"""Of no instance that is measured."""
HASH_DIGITS = 6
"""Of a file's hash in a trial's name: one in 16 million files is taken for another."""


class Instance(Hashable, Protocol):
    """Where a problem comes from; `seed` is also that of the planner."""

    @property
    def seed(self) -> int:
        """Not negative; also the planner's."""
        ...

    @property
    def name(self) -> str:
        """Tells it from every other one."""
        ...

    @property
    def kind(self) -> str:
        """What instances that differ by their seed alone are called together."""
        ...

    def problem(self, cell: BlocksCell) -> Problem:
        """The problem itself."""
        ...

    @property
    def warm_up(self) -> Instance:
        """One after whose planning nothing of this one is compiled or computed for the first time."""
        ...


@dataclass(frozen=True)
class ScatteredInstance:
    """Blocks scattered in the middle of the cell's workspace, by seed."""

    blocks: int
    density: float
    seed: int
    mixed: bool = False
    """Cuboids of several sizes instead of equal cubes."""

    @property
    def name(self) -> str:
        """Number, kind of blocks, density and seed, which decide it."""
        kind = "_mixed" if self.mixed else ""
        return f"{self.blocks}{kind}_{self.density:g}_seed{self.seed}"

    @property
    def kind(self) -> str:
        """Number, kind of blocks and density."""
        return f"{self.blocks} {'mixed ' if self.mixed else ''}blocks, density {self.density:g}"

    def problem(self, cell: BlocksCell) -> Problem:
        """The problem of the seed."""
        centre = cell.workspace.centre
        return make_instance(self.blocks, self.density, self.seed, centre=centre, mixed=self.mixed)

    @property
    def warm_up(self) -> ScatteredInstance:
        """Another one with the same goal grid, whose pattern database is kept."""
        return replace(self, seed=WARM_UP_SEED)


@dataclass(frozen=True)
class FileInstance:
    """A problem file's text, as read."""

    stem: str
    text: str
    seed: int

    @classmethod
    def read(cls, path: Path, seed: int) -> FileInstance:
        """Read and check a file.

        Raises:
            ConfigError: there is none, it is no problem file, or the problem contradicts itself.
        """
        if not path.is_file():
            raise ConfigError(f"{path}: no such file; config/scenarios/blocks/example.yaml is an example")
        text = read_text(path)
        if fault := find_fault(parse_problem(text, str(path), blocks_cell())):
            raise ConfigError(f"{path}: {fault.text}")
        return cls(path.stem, text, seed)

    @property
    def name(self) -> str:
        """By the file's name and content, so that a changed file is another instance."""
        return f"{self.stem}_{sha256(self.text.encode()).hexdigest()[:HASH_DIGITS]}_seed{self.seed}"

    @property
    def kind(self) -> str:
        """The file's name."""
        return self.stem

    def problem(self, cell: BlocksCell) -> Problem:
        """The problem of the file."""
        return parse_problem(self.text, self.stem)

    @property
    def warm_up(self) -> FileInstance:
        """The instance itself: its goals are its own."""
        return self


def wanted_instances(
    blocks: int, density: float, seeds: Sequence[int], files: Sequence[Path], *, mixed: bool = False
) -> list[Instance]:
    """The instances of a benchmark; files take the place of generated ones."""
    if files:
        return [FileInstance.read(path, seeds[0]) for path in files]
    return [ScatteredInstance(blocks, density, seed, mixed) for seed in seeds]
