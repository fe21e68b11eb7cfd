"""Whether MuJoCo can be loaded with the OpenGL that `MUJOCO_GL` asks for."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping

from pack_core.errors import ConfigError

VARIABLE = "MUJOCO_GL"
EGL = "libEGL.so.1"


def check_backend(environment: Mapping[str, str]) -> None:
    """Make sure that importing MuJoCo, which loads the backend, does not end in a library's traceback.

    With EGL, the usual one, this takes no time worth mentioning; MuJoCo is imported only with another one.

    Raises:
        ConfigError: it cannot be loaded.
    """
    backend = environment.get(VARIABLE, "")
    if not backend:
        return
    try:
        if backend == "egl":
            ctypes.CDLL(EGL)
        else:
            import mujoco  # noqa: F401
    except Exception as error:  # whatever the bindings of the backend raise
        raise ConfigError(
            f"{VARIABLE} is '{backend}', with which MuJoCo cannot be loaded: {error}; set {VARIABLE}=egl, or "
            "install the library that it needs"
        ) from error
