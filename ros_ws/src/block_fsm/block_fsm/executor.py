"""Carries out rearrangements: perceive, plan, and for every action verify, act, verify; replan.

It is a conversation. `start` gives the first request, and each answer gives the next, until there is an
outcome: who answers, and on which clock, is not its concern.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import Any

from block_fsm.deviation import Poses, as_seen, displaced, disturbed, is_on_line, is_pushed_home
from block_fsm.executor_config import ExecutorConfig
from block_fsm.motions import Motions, TableObstacles
from block_fsm.outcome import Ended, ExitReason, Outcome, Phase, Refused, Tally
from block_fsm.requests import Answer, ExecutorRequest, PlanFor
from block_fsm.skills import Asking, Skills
from block_fsm.task import RearrangeTask
from pack_core.blocks.plan import Action, PickPlace, Plan, Push
from pack_core.errors import PackError


class Executor:
    """Carries out one rearrangement, from the first picture to an outcome.

    Args:
        task: the goals.
        config: tolerances, heights and speeds.
        motions: makes the arm's paths.
        obstacles: makes what they are checked against.
        grip_force: that blocks are held with [N].

    Attributes:
        plan: the newest; None while it is being made.
        done: how many of its actions were carried out.
        action: the one under way, from its first move to the pictures after it.
        outcome: once it has ended.
    """

    def __init__(
        self,
        task: RearrangeTask,
        config: ExecutorConfig,
        motions: Motions,
        obstacles: TableObstacles,
        grip_force: float,
    ) -> None:
        self._task, self._config = task, config
        self._skills = Skills(task, config, motions, obstacles, grip_force)
        self.plan: Plan | None = None
        self.done = 0
        self.action: Action | None = None
        self.outcome: Outcome | None = None
        self._tally = Tally()
        self._refusals: list[Refused] = []
        self._conversation = self._run()

    @property
    def phase(self) -> Phase:
        """What is being done now."""
        return self._skills.phase

    @property
    def tally(self) -> Tally:
        """What was done so far."""
        return replace(self._tally, failed_grasps=self._skills.failed_grasps)

    def start(self) -> ExecutorRequest:
        """The first request."""
        request = self.answer(None)
        assert request is not None
        return request

    def answer(self, answer: Answer | None) -> ExecutorRequest | None:
        """Take the answer to the last request; the next one, or None when there is an outcome."""
        try:
            return self._conversation.send(answer)
        except StopIteration:
            return None

    def cancel(self, reason: ExitReason, message: str) -> Outcome:
        """End where it is; the arm is for the caller to stop."""
        if self.outcome is None:
            self._conversation.close()
            self._end(reason, message)
        assert self.outcome is not None
        return self.outcome

    def _run(self) -> Asking:
        try:
            yield from self._arrange()
            self._end(ExitReason.ARRANGED, "all blocks are in place")
        except Ended as end:
            self._end(end.reason, str(end))

    def _arrange(self) -> Asking:
        """Plan and act until there is nothing left to do."""
        yield from self._skills.clear_view()
        yield from self._skills.look()
        most = None
        while (plan := (yield from self._plan())).actions:
            most = most or 2 * len(plan.actions) + self._config.spare_actions
            predicted = list(plan.states(self._skills.seen))
            for self.done, action in enumerate(plan.actions):
                if self.tally.actions >= most:
                    raise Ended(ExitReason.NO_PROGRESS, f"{most} actions, and blocks are still out of place")
                if not self._is_as_predicted(action, predicted[self.done]):
                    break
                if not (yield from self._act(as_seen(action, self._skills.seen[action.block]))):
                    break

    def _plan(self) -> Generator[ExecutorRequest, Any, Plan]:
        self._skills.phase = Phase.PLAN
        self._tally = replace(self._tally, plans=self._tally.plans + 1)
        self.plan, self.done = None, 0
        refused = tuple(refusal.primitive for refusal in self._refusals)
        plan: Plan = yield PlanFor(self._task.problem(self._skills.seen, refused))
        self.plan = plan
        if not plan.is_solved:
            because = "".join(f"; the arm refused: {refusal}" for refusal in self._refusals)
            raise Ended(ExitReason.NO_PLAN, f"{plan.status.name}: {plan.diagnosis.text}{because}")
        return plan

    def _is_as_predicted(self, action: Action, predicted: Poses) -> bool:
        tolerance, seen = self._config.tolerance, self._skills.seen
        if isinstance(action, Push) and not is_on_line(action, seen[action.block], tolerance):
            return False
        return seen.keys() == predicted.keys() and not displaced(seen, predicted, tolerance)

    def _act(self, action: Action) -> Generator[ExecutorRequest, Any, bool]:
        """Carry out an action and look; False where the plan no longer holds."""
        before, self.action = self._skills.seen, action
        refusal = yield from self._carry_out(action)
        yield from self._skills.look()
        # Blocks without a goal may be taken away: the rest is planned anew without them.
        if gone := sorted((before.keys() & self._task.goals.keys()) - self._skills.seen.keys()):
            raise Ended(ExitReason.NOT_SEEN, f"no longer in the cell: {', '.join(gone)}; was it reset?")
        self.action = None
        return refusal is None and self._verify(action, before, self._skills.seen)

    def _carry_out(self, action: Action) -> Generator[ExecutorRequest, Any, Refused | None]:
        """Do what an action says, or remember what the arm cannot do as long as the table is as it is."""
        try:
            yield from self._skills.carry_out(action)
        except Refused as refusal:
            self._refusals.append(refusal)
            self._tally = replace(self._tally, refusals=self._tally.refusals + 1)
            if len(self._refusals) >= self._config.refusals:
                reason = f"{len(self._refusals)} actions in a row refused, the last: {refusal}"
                raise Ended(ExitReason.MOTION_FAILED, reason) from refusal
            return refusal
        self._refusals.clear()
        if isinstance(action, PickPlace):
            self._tally = replace(self._tally, picks=self._tally.picks + 1)
        else:
            self._tally = replace(self._tally, pushes=self._tally.pushes + 1)
        return None

    def _verify(self, action: Action, before: Poses, after: Poses) -> bool:
        tolerance, block = self._config.tolerance, action.block
        if isinstance(action, Push):
            is_there = is_pushed_home(action, after[block], tolerance)
        else:
            is_there = not displaced(after, {block: action.end}, tolerance)
        is_calm = not disturbed(before, after, block, tolerance)
        self._tally = replace(
            self._tally, deviations=self._tally.deviations + (not is_there),
            disturbances=self._tally.disturbances + (not is_calm),
        )  # fmt: skip
        return is_there and is_calm

    def _end(self, reason: ExitReason, message: str) -> None:
        if self.outcome is not None:
            raise PackError("the executor has ended already")
        self._skills.phase = Phase.DONE
        self.outcome = Outcome(reason, message, self.tally, *self._task.errors(self._skills.seen))
