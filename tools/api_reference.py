"""Builds the reference of the code from its docstrings, and checks it: `make docs`.

Every module must import and every link must lead somewhere, or the exit code is 1 and the reasons are listed.
"""

from __future__ import annotations

import re
import shutil
import sys
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from pdoc import pdoc, render

ROOT = Path(__file__).resolve().parent.parent
HREF = re.compile(r'href="([^"]+)"')
ANCHOR = re.compile(r'id="([^"]+)"')
SCRIPT = re.compile(r"<script.*?</script>", re.DOTALL)
FAILURE = "Couldn't import"
"""How pdoc's warning of a module begins that cannot be imported. It also warns of annotations whose names
only type checkers import, and shows those as they are written."""


def packages() -> list[str]:
    """The project's Python packages, but for generated ones."""
    return sorted(path.parent.name for path in ROOT.glob("ros_ws/src/*/*/__init__.py"))


def build(output: Path) -> list[str]:
    """Write the pages; returns what pdoc could not take up, in words."""
    render.configure(docformat="google", show_source=False, footer_text=f"PackCell {version()}")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        pdoc(*packages(), output_directory=output)
    said = (str(warning.message) for warning in caught)
    return [text.splitlines()[0] for text in said if text.startswith(FAILURE)]


def version() -> str:
    """The project's version."""
    return (ROOT / "VERSION").read_text().strip()


@cache
def anchors(page: Path) -> frozenset[str]:
    """The places of a page that a link can name."""
    return frozenset(ANCHOR.findall(page.read_text()))


def broken_links(output: Path) -> Iterator[str]:
    """Links to files or places that are not there, with their page.

    pdoc itself links to members that it does not list, such as an inherited constructor; their class must be
    there.
    """
    for page in sorted(output.rglob("*.html")):
        for link in set(HREF.findall(SCRIPT.sub("", page.read_text()))):
            place, _, anchor = link.partition("#")
            if "://" in link or link.startswith("data:"):
                continue
            target = (page.parent / place).resolve() if place else page
            if not target.is_file() or (anchor and not {anchor, anchor.rpartition(".")[0]} & anchors(target)):
                yield f"{page.relative_to(output)}: {link} leads nowhere"


def main() -> int:
    """Build and check; returns the exit code."""
    output = ROOT / "site"
    shutil.rmtree(output, ignore_errors=True)  # it may have pages of modules that are gone
    wrong = build(output) + list(broken_links(output))
    pages = len(list(output.rglob("*.html")))
    sys.stdout.write("".join(f"{line}\n" for line in [*wrong, f"{pages} pages: {output / 'index.html'}"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
