"""Dependencies run one way, floor by floor, and package.xml says so.

interfaces <- core <- perception, calibration, motion <- leaves <- baselines <- lockstep <- bring-up
"""

import ast
from functools import cache
from xml.etree import ElementTree

import pytest
from ament_index_python.packages import get_packages_with_prefixes

from pack_core.cells import CELLS
from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/package.xml"))
PYTHON_PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/setup.py"))
FLOORS = (
    {"pack_interfaces", "tf2_msgs", "control_msgs"},
    {"pack_core"},
    {"pallet_calibration", "pack_perception", "pack_motion"},
    {"pack_sim", "pack_planner", "pack_mpc", "pallet_fsm", "block_fsm", "pack_evaluation"},
    {"pack_baselines"},
    {"pack_lockstep", "pack_viewer"},
    {"pack_bringup"},
)  # fmt: skip
"""Packages of one floor never import each other."""
BASELINES = "pack_baselines"
"""What exists to be compared with: it registers itself, and nothing imports it."""
OF_ALL_CELLS = ("pack_evaluation", "pack_lockstep", "pack_viewer", "pack_bringup", "pack_core", "pack_sim")
"""Packages that serve all cells."""
DRAWING = {"matplotlib", "jinja2", "imageio_ffmpeg", "PIL"}
THE_PAGE = {"viser", "websockets"}
"""What the page in the browser is made with."""


@cache
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
    floor = next(k for k, packages in enumerate(FLOORS) if package in packages)
    return set().union(*FLOORS[:floor])


def cells_in(module: str) -> set[str]:
    """The cells that a module's dotted name belongs to."""
    return set(CELLS) & set(module.split("."))


@cache
def module_imports() -> list[tuple[str, str]]:
    """Every pair of modules of this workspace of which the first imports the second."""
    pairs = []
    for package in PYTHON_PACKAGES:
        for path in (SOURCES / package / package).rglob("*.py"):
            name = ".".join(path.relative_to(SOURCES / package).with_suffix("").parts)
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in PACKAGES:
                    pairs.append((name, str(node.module)))
    return pairs


def test_every_package_stands_on_one_floor() -> None:
    assert sorted(package for floor in FLOORS for package in floor) == PACKAGES


def test_cells_never_import_each_other() -> None:
    crossing = [
        (one, other)
        for one, other in module_imports()
        if cells_in(one) and cells_in(other) and cells_in(one).isdisjoint(cells_in(other))
    ]
    assert crossing == []


def test_robots_and_kinematics_import_no_cell() -> None:
    shared = ("pack_core.robots", "pack_core.kinematics", "pack_core.motion")
    assert [pair for pair in module_imports() if pair[0].startswith(shared) and cells_in(pair[1])] == []


@pytest.mark.parametrize("package", OF_ALL_CELLS)
def test_shared_files_of_a_package_import_no_cell(package: str) -> None:
    """They ask the register of cells, pack_core/cells.py, for a cell's part."""
    shared = [pair for pair in module_imports() if pair[0].startswith(package) and not cells_in(pair[0])]
    assert [pair for pair in shared if cells_in(pair[1])] == []


@pytest.mark.parametrize("package", sorted(set().union(*FLOORS[1:4]) - {"pack_evaluation"}))
def test_no_node_needs_what_draws_plots_and_reports(package: str) -> None:
    assert imported_packages(package) & DRAWING == set()


@pytest.mark.parametrize("package", [name for name in PYTHON_PACKAGES if name != "pack_viewer"])
def test_only_the_viewer_needs_what_the_page_is_made_with(package: str) -> None:
    assert imported_packages(package) & THE_PAGE == set()


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_a_package_imports_only_what_is_below_it(package: str) -> None:
    assert imported_packages(package) & set(PACKAGES) <= allowed(package)


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_no_package_imports_the_baselines(package: str) -> None:
    assert BASELINES not in imported_packages(package)


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_package_xml_declares_every_ros_package_that_is_imported(package: str) -> None:
    undeclared = imported_packages(package) & set(get_packages_with_prefixes()) - declared_dependencies(
        package
    )
    assert undeclared == set()


@pytest.mark.parametrize("package", PYTHON_PACKAGES)
def test_package_xml_declares_no_package_of_this_workspace_in_vain(package: str) -> None:
    assert declared_dependencies(package) & set(PACKAGES) <= allowed(package)
