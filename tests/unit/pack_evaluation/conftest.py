from pathlib import Path

import pytest

from pack_bringup.recording import recorder
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of many chunks."""
    folder = tmp_path_factory.mktemp("run")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recorder, "FLUSH_PERIOD", 1e-4)
        writer = GoalWriter(folder)
        writer.write_goal(1.0, OUTCOME)
        writer.close()
    return folder
