"""The option `--domain` of commands that join a live graph."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from pack_core.network import LAST_DOMAIN, domain_in

Domain = Annotated[
    int | None, typer.Option(min=0, max=LAST_DOMAIN, help="ROS domain id; the environment's if not given.")
]


def domain_of(option: int | None) -> int:
    """The domain that an option names, else the environment's, else 0 as ROS has it."""
    return domain_in(os.environ) or 0 if option is None else option


def domain_words(option: int | None) -> str:
    """The option as other commands need it, after a space; empty if they do not need it."""
    return "" if option is None or option == domain_of(None) else f" --domain {option}"
