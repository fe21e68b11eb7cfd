"""One version: that of the file VERSION at the top of the repository."""

from xml.etree import ElementTree

import pytest

from pack_core.paths import project_root
from pack_evaluation.provenance import installed_versions, project_version

PACKAGES = sorted((project_root() / "ros_ws" / "src").glob("*/package.xml"))


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: path.parent.name)
def test_every_package_has_the_version_of_the_project(path) -> None:
    assert ElementTree.parse(path).findtext("version") == project_version()


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: path.parent.name)
def test_no_setup_file_states_a_version_of_its_own(path) -> None:
    setup = path.with_name("setup.py")
    assert not setup.is_file() or 'ElementTree.parse("package.xml").findtext("version")' in setup.read_text()


def test_results_name_the_version_that_made_them() -> None:
    assert installed_versions()["packcell"] == project_version()


def test_the_citation_names_this_version() -> None:
    lines = (project_root() / "CITATION.cff").read_text().splitlines()
    assert f"version: {project_version()}" in lines
