"""docs/cells/palletizing/states.md is what the tables of the palletizing machine say."""

from pack_core.paths import project_root
from pallet_fsm.drawing import states_page


def test_states_page_equals_the_tables() -> None:
    page = (project_root() / "docs" / "cells" / "palletizing" / "states.md").read_text()
    assert page == states_page(), "run: pack states > docs/cells/palletizing/states.md"
