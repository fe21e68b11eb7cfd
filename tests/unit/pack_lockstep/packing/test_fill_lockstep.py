"""What a fill job without ROS reports."""

from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import FillMethod
from pack_core.packing.objects import Box
from pack_core.packing.packing_list import PackingList
from pack_lockstep.packing.fill_lockstep import FillLockstep
from pack_lockstep.packing.lockstep_config import lockstep_config

ITEMS = [Box(name=name, shape="box", size=(0.09, 0.06, 0.1), mass=0.3) for name in ("first", "second")]


def test_objects_that_a_job_never_came_to_were_given_all_the_same() -> None:
    given = PackingList(objects=ITEMS)
    lockstep = FillLockstep(packing_cell(), given, lockstep_config(), FillMethod.CONTACT, 1)
    measures = lockstep.result().measures()
    assert (measures["objects"], measures["given"]) == (0, 2)
