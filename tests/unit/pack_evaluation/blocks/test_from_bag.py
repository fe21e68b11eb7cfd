"""Recordings of the blocks cell."""

import json
from pathlib import Path

import pytest

from pack_core.errors import BagError
from pack_evaluation.blocks.from_bag import FIELDS, read_result


def test_a_result_of_another_version_is_refused_by_name() -> None:
    result = dict.fromkeys(FIELDS, 0)
    assert read_result(json.dumps(result), Path("bag")) == result
    del result["refusals"]
    with pytest.raises(BagError, match="bag: the result lacks refusals"):
        read_result(json.dumps(result), Path("bag"))
