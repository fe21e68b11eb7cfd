"""The register of rearrangement planners: nodes, lockstep and commands ask here for a planner by its name."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field, PositiveFloat

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_core.register import Register, with_sections
from pack_planner.rearrangement.rearrangement_planner import RearrangementPlanner

METHODS: Register[type[RearrangementPlanner]] = Register(
    "rearrangement planner",
    "pack_planner.rearrangement_planners",
    {"beam": "pack_planner.rearrangement.beam.beam_planner:BeamPlanner"},
)
"""The planners by the names of their methods, the default first."""

DEFAULT_METHOD = "beam"

MethodName = Annotated[str, AfterValidator(METHODS.known)]
"""A configuration's field that names a method."""


@with_sections(METHODS)
class RearrangementConfig(Config):
    """Every planner with its parameters; a field's name is the name of its method."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    def planner(self, method: str) -> RearrangementPlanner:
        """The planner of a method.

        Raises:
            ConfigError: there is no such method.
        """
        planner: RearrangementPlanner = getattr(self, METHODS.checked(method))
        return planner


class PlanningConfig(RearrangementConfig):
    """All planners, and which of them plans for how long where a request says nothing."""

    method: Annotated[MethodName, NEXT_REQUEST] = Field(
        DEFAULT_METHOD, description="the planner asked where a request names none"
    )
    budget: Annotated[PositiveFloat, NEXT_REQUEST] = Field(
        1.0, description="time for a plan where a request says none [s]"
    )
