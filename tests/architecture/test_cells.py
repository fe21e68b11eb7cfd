"""Every registered cell has every part, and nothing but the register lists the cells."""

import re

import pytest

from pack_core.cells import CELLS, PARTS, cell_part, cells_with, check_cell, optional_cell_part
from pack_core.errors import ConfigError
from pack_core.paths import config_path, project_root

REGISTER = "pack_core/cells.py"
REQUIRED = [name for name, part in PARTS.items() if not part.is_optional]
OPTIONAL = [name for name, part in PARTS.items() if part.is_optional]


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("name", REQUIRED)
def test_every_cell_has_every_part(cell: str, name: str) -> None:
    assert cell_part(cell, name) is not None


@pytest.mark.parametrize("name", OPTIONAL)
def test_a_cell_that_does_without_an_optional_part_says_none(name: str) -> None:
    having = cells_with(name)
    assert having, f"no cell has the part {name}: take it out of PARTS"
    for cell in CELLS:
        assert (optional_cell_part(cell, name) is not None) == (cell in having)


@pytest.mark.parametrize("cell", CELLS)
def test_every_cell_has_its_configuration(cell: str) -> None:
    files = [config_path("cells", f"{cell}.yaml"), config_path("graphs", f"{cell}.yaml")]
    assert [path for path in files if not path.is_file()] == []
    assert list(config_path("nodes", cell).glob("*.yaml"))


def test_a_cell_that_is_not_registered_is_refused_with_those_that_are() -> None:
    with pytest.raises(ConfigError, match=r"no cell 'juggling'; allowed: .*packing"):
        check_cell("juggling")


def test_a_part_that_a_cell_lacks_is_named_with_its_module() -> None:
    with pytest.raises(ConfigError, match=r"'blocks' has no preset .*pack_bringup\.blocks\.goals"):
        cell_part("blocks", "preset")


def test_only_the_register_lists_the_cells() -> None:
    """A list of cells elsewhere would have to be found and extended for the next cell."""
    together = re.compile("[^\n]*".join(f'"{cell}"' for cell in CELLS))
    listing = [
        str(path)
        for path in (project_root() / "ros_ws" / "src").glob("*/**/*.py")
        if together.search(path.read_text()) and not str(path).endswith(REGISTER)
    ]
    assert listing == []
