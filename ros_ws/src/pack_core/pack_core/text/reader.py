"""The one way in for text from outside: files, uploads, and text in messages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pack_core.errors import ConfigError
from pack_core.text.limits import MOST_BYTES, too_large
from pack_core.text.yaml_text import parse_yaml


def read_text(path: Path) -> str:
    """The text of a file.

    Raises:
        ConfigError: there is no such file, or it is too large, or not UTF-8.
    """
    try:
        if path.is_file() and (size := path.stat().st_size) > MOST_BYTES:
            raise ConfigError(too_large(str(path), size))
        return decoded(path.read_bytes(), str(path))
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except (OSError, ValueError) as error:  # ValueError: a path with a zero byte
        why = error.strerror if isinstance(error, OSError) else error
        raise ConfigError(f"{path}: cannot be read: {why}") from error


def decoded(content: bytes, source: str) -> str:
    """The text that bytes hold; `source` names them in errors.

    Raises:
        ConfigError: there are too many, or they are not UTF-8.
    """
    if len(content) > MOST_BYTES:
        raise ConfigError(too_large(source, len(content)))
    try:
        return content.decode("utf-8-sig")  # with or without the mark that some editors put in front
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ConfigError(
            f"{source}, line {line}: byte {content[error.start]:#04x} is no text in UTF-8; "
            "allowed: UTF-8, save the file in it"
        ) from error


def load_yaml(path: Path) -> Any:
    """The values of a YAML file; raises ConfigError."""
    return parse_yaml(read_text(path), str(path))
