"""Draws the machine from its tables, as mermaid and as tables: the page docs/cells/palletizing/states.md."""

from __future__ import annotations

from collections.abc import Iterable

from pallet_fsm.states import PROFILES, ROWS, STEPS, Profile, State, StateRow
from pallet_fsm.transitions import CYCLE, RESUME, TRANSITIONS, Transition

PAGE = """# States of the palletizing cell

Written by `pack states` from the tables in `pallet_fsm/states.py` and `pallet_fsm/transitions.py`.

## The cycle

```mermaid
stateDiagram-v2
{cycle}
```

## Faults

A state that is not drawn here knows no fault. `{resume}` goes back to the state that was interrupted.

```mermaid
flowchart LR
{faults}
```

## The states

{states}
"""
RESUMED = "interrupted state"


def states_page() -> str:
    """The text of docs/cells/palletizing/states.md."""
    rest = [row for row in TRANSITIONS if row not in CYCLE]
    return PAGE.format(
        cycle="\n".join(_cycle(CYCLE)), faults="\n".join(_faults(rest)), states="\n".join(_table()),
        resume=RESUMED,
    )  # fmt: skip


def _cycle(rows: Iterable[Transition]) -> Iterable[str]:
    for step in STEPS:
        yield f"    {step.state.name}: {step.state.label}"
    yield f"    [*] --> {State.SPAWN.name}"
    for row in rows:
        target = "[*]" if row.next is State.DONE else _next(row).name
        yield f"    {row.state.name} --> {target}: {_words(row)}"


def _faults(rows: Iterable[Transition]) -> Iterable[str]:
    """One arrow for each event, guard and target; all numbered states that share them share the arrow."""
    groups: dict[tuple[str, str, str], list[State]] = {}
    for row in rows:
        target = RESUMED if row.next is RESUME else _next(row).label
        source = "" if row.state in ROWS else row.state.label
        groups.setdefault((source, _words(row), target), []).append(row.state)
    for (source, words, target), states in groups.items():
        name = source or _numbers(states)
        yield f'    {_id(name)}["{name}"] -->|{words}| {_id(target)}["{target}"]'


def _table() -> Iterable[str]:
    yield "| state | what | gripper | target within | " + " | ".join(PROFILES) + " |"
    yield "|" + "---|" * (4 + len(PROFILES))
    for row in ROWS.values():
        cells = [
            row.state.label, row.what, row.grip.value, row.check.value if row.check else "",
            *(_run(profile, row) for profile in PROFILES.values()),
        ]  # fmt: skip
        yield "| " + " | ".join(cells) + " |"


def _run(profile: Profile, row: StateRow) -> str:
    """How a profile runs a state."""
    if row.mode is None:
        return ""
    mode = profile.mode(row.state)
    speed = mode.value.lower() if mode else "at once"
    return f"{speed}, {'stops' if profile.stops_at(row.state) else 'passed'}"


def _numbers(states: Iterable[State]) -> str:
    """Runs of numbered states as `2-20`, then the names of those without a number."""
    values = [state.value for state in states]
    runs: list[list[int]] = []
    for number in sorted(value for value in values if isinstance(value, int)):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [value for value in values if isinstance(value, str)]
    return ", ".join([*(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs), *words])


def _words(row: Transition) -> str:
    return f"{row.event.value}, {row.guard.value}" if row.guard else row.event.value


def _next(row: Transition) -> State:
    assert row.next is not None
    return row.next


def _id(text: str) -> str:
    return "s_" + "".join(c if c.isalnum() else "_" for c in text)
