"""Starts nodes with keys of their own (SROS 2), on machines whose ROS 2 was built with DDS security."""

from __future__ import annotations

from pathlib import Path

from pack_core.errors import ConfigError

ENCLAVES = "enclaves"
"""Folder of a keystore that has a folder for every enclave."""


def security_environment(keystore: str) -> dict[str, str]:
    """Environment variables with which every node needs a key of a keystore; none where no keystore is given.

    Raises:
        ConfigError: there is no keystore.
    """
    if not keystore:
        return {}
    path = Path(keystore).expanduser().resolve()
    if not (path / ENCLAVES).is_dir():
        raise ConfigError(f"keystore:={keystore}: no keystore there; tools/keystore.sh CELL DIR makes one")
    return {
        "ROS_SECURITY_KEYSTORE": str(path),
        "ROS_SECURITY_ENABLE": "true",
        "ROS_SECURITY_STRATEGY": "Enforce",  # without a key a node does not start
    }


def enclave_arguments(keystore: str, cell: str, node: str) -> list[str]:
    """ROS arguments that give a node its key; none where no keystore is given.

    Raises:
        ConfigError: the keystore has no key for the node.
    """
    if not keystore:
        return []
    enclave = f"/packcell/{cell}/{node}"
    if not Path(keystore).expanduser().joinpath(ENCLAVES, enclave[1:]).is_dir():
        raise ConfigError(
            f"keystore:={keystore}: no key {enclave}; tools/keystore.sh {cell} {keystore} makes it"
        )
    return ["--enclave", enclave]
