"""What the packing cell does and has done, from its goals' stages and ends."""

from __future__ import annotations

from typing import Any

from pack_bringup.opcua.production import Production
from pack_core.packing import topics
from pack_core.text.json_text import parse_json


class PackingProduction(Production):
    """Objects count once they are in the container, containers once a list's job has ended as it should."""

    items, carriers = "Objects", "Containers"
    topics = (topics.MPC_STATUS, topics.RESULT, topics.FILL_PROGRESS, topics.FILL_RESULT)

    def __init__(self) -> None:
        super().__init__()
        self._job_start, self._job_packed = float("nan"), 0

    def take(self, topic: str, message: Any) -> None:
        """Take an iteration's status, the end of a goal, or where a list's job stands."""
        if topic == topics.MPC_STATUS:
            self.step, self.fault = message.stage, message.warning
            return
        report = parse_json(message.data, topic)
        if topic == topics.RESULT:
            self.message = str(report["message"])
            self.placed += bool(report["success"])
            return
        self._follow_job(report)
        if topic == topics.FILL_RESULT:
            self.message, self.item = str(report["message"]), ""
            is_whole = report["exit_reason"] == "done" and all(row["packed"] for row in report["objects"])
            self.pallets += bool(report["objects"]) and is_whole
        else:
            self.step, self.item = report["stage"], report["object"] or ""

    def _follow_job(self, report: dict[str, Any]) -> None:
        """Each report lists all objects that the job has handled so far."""
        if report["start"] != self._job_start:
            self._job_start, self._job_packed = report["start"], 0
        packed = sum(row["packed"] for row in report["objects"])
        self.placed += packed - self._job_packed
        self._job_packed = packed


PRODUCTION = PackingProduction
"""For the register of cells."""
