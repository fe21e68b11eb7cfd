"""Reports as one HTML file that needs nothing beside it."""

from __future__ import annotations

from base64 import b64encode
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined


def render(template: Path, **values: Any) -> str:
    """Render a Jinja template; values are escaped for HTML."""
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    return environment.from_string(template.read_text()).render(**values)


def embedded(path: Path) -> str:
    """A file's content in base64, to embed it in a page."""
    return b64encode(path.read_bytes()).decode()
