"""Reports as one HTML file that needs nothing beside it."""

from __future__ import annotations

from base64 import b64encode
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined


def render(template: str, **values: Any) -> str:
    """Render a Jinja template, by its path below this package; values are escaped for HTML."""
    return _environment().get_template(template).render(**values)


@cache
def _environment() -> Environment:
    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(autoescape=True, undefined=StrictUndefined, loader=loader)
    environment.filters["embedded"] = embedded
    return environment


def embedded(path: Path) -> str:
    """A file's content in base64, to embed it in a page."""
    return b64encode(path.read_bytes()).decode()
