"""The rearrangement planners there are, by name: nodes, lockstep and commands ask here."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_core.errors import PackError
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.pirs.pirs_planner import PirsPlanner
from pack_planner.rearrangement.rearrangement_planner import RearrangementPlanner


class RearrangementConfig(Config):
    """Every planner with its parameters; a field's name is the name of its method."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    beam: BeamPlanner = Field(default_factory=BeamPlanner)
    pirs: PirsPlanner = Field(default_factory=PirsPlanner)

    def planner(self, method: str) -> RearrangementPlanner:
        """The planner of a method.

        Raises:
            PackError: there is no such method.
        """
        planner: RearrangementPlanner = getattr(self, checked_method(method))
        return planner


METHODS: tuple[str, ...] = tuple(RearrangementConfig.model_fields)
"""Names of the methods, the default first."""


def checked_method(name: str) -> str:
    """The name, if there is a method called so.

    Raises:
        PackError: there is none.
    """
    if name not in METHODS:
        raise PackError(f"method is '{name}'; allowed: {', '.join(METHODS)}")
    return name


def _validated(name: str) -> str:
    if name not in METHODS:
        raise ValueError(" or ".join(METHODS))
    return name


MethodName = Annotated[str, AfterValidator(_validated)]
"""A configuration's field that names a method."""
