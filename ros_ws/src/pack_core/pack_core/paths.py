"""Where the project's files are, from a source checkout or an installed workspace alike."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from pack_core.errors import ConfigError

ROOT_VARIABLE = "PACKCELL_ROOT"


@cache
def project_root() -> Path:
    """The folder that holds `config/`, `bags/` and `ros_ws/`.

    `PACKCELL_ROOT` decides where it is set; otherwise it is looked for upwards from this file
    and from the working directory.

    Raises:
        ConfigError: no such folder was found.
    """
    if given := os.environ.get(ROOT_VARIABLE):
        return Path(given).resolve()
    # `parents` leaves the path itself out: "_" makes the working directory one of them.
    for start in (Path(__file__).resolve(), Path.cwd() / "_"):
        for folder in start.parents:
            if (folder / "config" / "graphs").is_dir():
                return folder
    raise ConfigError(
        f"no PackCell checkout found above {Path(__file__).resolve().parent} or {Path.cwd()}: "
        f"set {ROOT_VARIABLE} to the folder that holds config/graphs"
    )


def config_path(*parts: str) -> Path:
    """A file below `config/`, for example `config_path("nodes", "packing", "mpc.yaml")`."""
    return project_root().joinpath("config", *parts)


def bags_path() -> Path:
    """The folder that recordings are written to."""
    return project_root() / "bags"
