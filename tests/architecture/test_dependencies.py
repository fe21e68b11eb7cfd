"""Dependencies run one way: interfaces <- core <- leaves <- bringup, and package.xml says so."""

import ast
from xml.etree import ElementTree

import pytest
from ament_index_python.packages import get_packages_with_prefixes

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/package.xml"))
PYTHON_PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/setup.py"))
BASE = {"pack_interfaces", "pack_core"}


def imported_packages(package: str) -> set[str]:
    """Top-level names that the package's own modules import, itself left out."""
    names: set[str] = set()
    for path in [*(SOURCES / package / package).rglob("*.py"), *(SOURCES / package / "launch").glob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                names.add(node.module.split(".")[0])
    return names - {package}


def declared_dependencies(package: str) -> set[str]:
    root = ElementTree.parse(SOURCES / package / "package.xml").getroot()
    return {str(item.text) for item in root if item.tag in {"depend", "exec_depend"}}


def allowed(package: str) -> set[str]:
    if package == "pack_core":
        return {"pack_interfaces"}
    return set(PACKAGES) if package == "pack_bringup" else BASE


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_a_package_imports_only_what_is_below_it(package: str) -> None:
    assert imported_packages(package) & set(PACKAGES) <= allowed(package)


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_package_xml_declares_every_ros_package_that_is_imported(package: str) -> None:
    undeclared = imported_packages(package) & set(get_packages_with_prefixes()) - declared_dependencies(
        package
    )
    assert undeclared == set()


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_package_xml_declares_no_package_of_this_workspace_in_vain(package: str) -> None:
    assert declared_dependencies(package) & set(PACKAGES) <= allowed(package)
