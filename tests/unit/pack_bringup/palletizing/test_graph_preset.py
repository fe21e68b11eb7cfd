"""A preset and its calibration reach every node that knows the cell."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from pack_bringup.graph.graph import conditions
from pack_bringup.palletizing.goals import NODES
from pack_core.errors import ConfigError
from pack_core.palletizing.calibration import CalibratedCamera, CellCalibration, PlacingError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import NOWHERE


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A calibration that found a cell under `real` to be as it is configured."""
    cell = palletizing_cell("real")
    gears = cell.imperfections.gears
    assert gears is not None
    path = tmp_path / "calibration.yaml"
    CellCalibration(
        preset="real",
        camera=CalibratedCamera(
            displacement=NOWHERE, focal_scale=1.0, centre_shift=(0.0, 0.0), lens=cell.camera.lens
        ),
        picking_table=NOWHERE, reorientation_table=NOWHERE, pallet=NOWHERE, gears=gears.assumed,
        predicted=PlacingError(mean=0.2, p95=0.4), simulated_s=275.0, estimates=(), covariance=(),
        residuals=(),
    ).write(path)  # fmt: skip
    return path


def test_every_node_that_knows_the_cell_gets_preset_and_calibration(file: Path) -> None:
    given = conditions("palletizing", "real", file)
    for node in NODES:
        assert yaml.safe_load(given[node]["preset"]) == "real"
        assert yaml.safe_load(given[node]["calibration"]) == str(file.resolve())
    assert yaml.safe_load(given["recorder"]["preset"]) == "real"


def test_without_a_file_the_nodes_are_told_of_no_calibration() -> None:
    given = conditions("palletizing", "real", None)
    assert all("calibration" not in parameters for parameters in given.values())


def test_a_calibration_of_another_preset_is_refused(file: Path) -> None:
    with pytest.raises(ConfigError, match="made under preset 'real', and this cell has 'rigid'"):
        conditions("palletizing", "", file)


def test_a_cell_without_calibrations_says_which_have_them(file: Path) -> None:
    with pytest.raises(ConfigError, match=r"'blocks' takes no calibration; .*packing, palletizing"):
        conditions("blocks", "", file)


def test_what_a_preset_changes_in_the_nodes_reaches_them() -> None:
    given = conditions("palletizing", "thesis", None)
    assert yaml.safe_load(given["fsm"]["profile"]) == "thesis"
    assert yaml.safe_load(given["motion"]["parameters"]) == "table_4_1"
    assert yaml.safe_load(given["sim"]["has_limits"]) is False


def test_a_preset_that_there_is_not_is_refused() -> None:
    with pytest.raises(ConfigError, match="perfect"):
        conditions("palletizing", "perfect", None)
