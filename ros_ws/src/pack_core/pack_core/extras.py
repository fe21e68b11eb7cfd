"""How packages are installed that the project can do without."""

from __future__ import annotations


def install_command(extra: str, option: str) -> str:
    """The command for the user.

    Args:
        extra: name of the file of requirements/ that has the packages.
        option: of uv, as the file was made for.
    """
    return f".venv/bin/uv pip install --python .venv/bin/python {option} -r requirements/{extra}.txt"
