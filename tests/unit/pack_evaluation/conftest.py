from pathlib import Path

import pytest

from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of many chunks."""
    folder = tmp_path_factory.mktemp("run")
    writer = GoalWriter(folder, chunk=20)
    writer.write_goal(1.0, OUTCOME)
    writer.close()
    return folder
