"""When a cell is recorded; apart, so that the command line need not load what writes bags."""

from typing import Literal

Record = Literal["goals", "always", "never"]
"""While goals run, always, or never."""
