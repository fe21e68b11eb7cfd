"""`pack benchmark palletizing --shift` takes no option that would have no effect."""

import pytest

from pack_bringup.palletizing.shift_command import refuse
from pack_core.errors import ConfigError


def test_options_for_orders_are_named() -> None:
    with pytest.raises(ConfigError, match=r"^--preset, --plots beside --shift; allowed: --streams"):
        refuse({"--order": None, "--preset": True, "--seeds": False, "--plots": True}, "--streams")


def test_a_shift_alone_is_taken() -> None:
    refuse({"--order": None, "--seeds": False, "--visitors": ""}, "--streams")
