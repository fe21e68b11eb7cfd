"""Takes from a Markdown page what a reader could follow or type: links, paths, shell commands, options."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pack_core.paths import project_root

FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
SHELL = {"", "bash", "sh", "console"}
"""Languages of code blocks that are typed into a shell; others are diagrams, YAML or Python."""
OPTION = re.compile(r"--?[a-z][a-z-]*")
PATH = re.compile(r"[\w.<>*-]*(/[\w.<>*-]+)+/?|[\w.<>*-]+/")


@dataclass(frozen=True)
class Page:
    """One Markdown page of this project."""

    path: Path

    @cached_property
    def text(self) -> str:
        """The page as it stands in its file."""
        return self.path.read_text()

    @cached_property
    def spans(self) -> list[str]:
        """What stands in backticks in running text, and the lines of the shell's code blocks."""
        lines = [line for language, block in FENCE.findall(self.text) if language in SHELL
                 for line in block.splitlines()]  # fmt: skip
        return [*SPAN.findall(FENCE.sub("", self.text)), *(line.strip() for line in lines)]

    @property
    def links(self) -> list[str]:
        """Targets of links to places in this project, with their `#heading`."""
        return [link for link in LINK.findall(self.text) if "://" not in link]

    @property
    def anchors(self) -> set[str]:
        """The page's headings as links name them."""
        plain = (re.sub(r"[^\w\s-]", "", heading.lower()) for heading in HEADING.findall(self.text))
        return {heading.strip().replace(" ", "-") for heading in plain}

    def commands(self, program: str) -> list[list[str]]:
        """The calls of a program, as lists of its arguments."""
        calls = []
        for span in self.spans:
            for part in re.split(r"&&|[|;]", span):
                arguments = split(part)
                if arguments[:1] and Path(arguments[0]).name == program:
                    calls.append(arguments[1:])
        return calls

    @property
    def options(self) -> list[str]:
        """Options that are named without their command."""
        return [span.split("=")[0].split()[0] for span in self.spans if OPTION.match(span)]

    @property
    def paths(self) -> list[str]:
        """Words with a slash in spans, but for absolute ones: topics, and places on the reader's machine."""
        words = (word.split(":=")[-1].split("::")[0] for span in self.spans for word in split(span))
        return [word for word in words if PATH.fullmatch(word) and not word.startswith("/")]


def split(text: str) -> list[str]:
    """Words of a shell command without its comment; split at blanks where quotes are not in pairs."""
    try:
        return shlex.split(text, comments=True)
    except ValueError:
        return text.split()


def pages() -> list[Page]:
    """The pages at the top, those in docs/, and those that lie beside what they describe."""
    root = project_root()
    found = [
        root / "bags" / "README.md",
        *root.glob("docs/**/*.md"),
        *root.glob("config/**/*.md"),
        *root.glob("ros_ws/src/*/README.md"),
        *root.glob("*.md"),
    ]
    return [Page(path) for path in sorted(found)]
