"""`--shift` of `pack demo` and `pack benchmark`: shifts in which everything moves, streams as geometry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from pack_bringup.cli.benchmark_run import RunOptions, run
from pack_bringup.cli.pursue import end_live, run_goal, run_nodes
from pack_core.errors import ConfigError

if TYPE_CHECKING:
    from pack_bringup.cli.options import CellAddress
    from pack_bringup.palletizing.goals import ShiftGoal
    from pack_bringup.viewers import PageProcess
    from pack_core.palletizing.shift_journal import ShiftEvent

SHIFTS = "palletizing_shift"
"""How the names of the folders of shifts begin."""

ShiftDemo = Annotated[
    bool,
    typer.Option(
        "--shift", help="Run a shift on simulated time instead: boxes come as they come, on a conveyor."
    ),
]
Boxes = Annotated[int, typer.Option(min=1, help="With --shift: it ends when so many have come.")]
ShiftGoalOption = Annotated[
    bool,
    typer.Option("--shift", help="Run a shift instead, of a cell that runs under `--preset shift`."),
]
ResumeNewest = Annotated[
    bool,
    typer.Option(
        "--resume", help="With --shift: go on with the shift of --output, by default with the newest one."
    ),
]
Resume = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="With --shift: go on with the shift of this folder, which was interrupted; boxes and seed are "
        "those that it was begun with.",
    ),
]
BoxesMoved = Annotated[
    int,
    typer.Option(
        min=0, help="With --shift: move so many boxes of each stream on simulated time; 0: geometry alone."
    ),
]
Shift = Annotated[
    bool,
    typer.Option("--shift", help="Place streams of unknown boxes online, as geometry, instead of orders."),
]
Streams = Annotated[int, typer.Option(min=1, help="With --shift: number of streams.")]
FirstStream = Annotated[int, typer.Option("--seed", min=0, help="With --shift: seed of the first stream.")]
Rule = Annotated[
    str,
    typer.Option(
        metavar="RULE",
        help="With --shift: what ranks places: touching, low_top, least_surface or bottom_left.",
    ),
]
Buffer = Annotated[int, typer.Option(min=0, help="With --shift: boxes that can be set aside.")]
Preview = Annotated[int, typer.Option(min=1, help="With --shift: boxes that are known and can be taken.")]
OpenPallets = Annotated[
    int, typer.Option(min=1, max=9, help="With --shift: pallets that are open at a time.")
]
Tipping = Annotated[
    float | None,
    typer.Option(
        metavar="G", min=0.0, max=1.0,
        help="With --shift: what boxes withstand by the closed tipping rule [g]. Default: 0.25.",
    ),
]  # fmt: skip
MaxPressure = Annotated[
    float | None, typer.Option(metavar="KPA", help="With --shift: largest pressure on a box. Default: any.")
]
Fragile = Annotated[
    float, typer.Option(min=0.0, max=1.0, help="With --shift: share of boxes on which nothing may stand.")
]


@dataclass(frozen=True)
class ShiftOptions:
    """The options of a benchmark of shifts, as the command line has them."""

    streams: int = 30
    seed: int = 7000
    rule: str = "touching"
    buffer: int = 2
    preview: int = 1
    open_pallets: int = 2
    tipping: float | None = None
    max_pressure: float | None = None
    fragile: float = 0.0
    boxes: int = 0

    def given(self) -> dict[str, bool]:
        """Whether each option differs from what it is by default."""
        return {
            f"--{field.name.replace('_', '-')}": getattr(self, field.name) != field.default
            for field in fields(self)
        }


DEFAULTS = ShiftOptions()
BOXES = 20
"""That come in a shift in which everything moves, unless another number is given."""


def require_shift(options: Mapping[str, Any]) -> None:
    """Raise ConfigError where options are given, by name, that are for shifts alone."""
    if given := [name for name, value in options.items() if value]:
        raise ConfigError(f"{', '.join(given)} without --shift; allowed: both, or neither of them")


def refuse(others: Mapping[str, Any], allowed: str) -> None:
    """Raise ConfigError where options are given, by name, that are for orders."""
    if given_too := [name for name, value in others.items() if value]:
        raise ConfigError(
            f"{', '.join(given_too)} beside --shift; allowed: {allowed}; the rest is for orders"
        )


def demo_shift(boxes: int, seed: int, folder: Path, *, is_resumed: bool) -> None:
    """Run a shift, report it, and leave 0 if all its boxes came and nothing went wrong, else 1.

    Args:
        boxes: it ends when so many have come.
        seed: of what comes.
        folder: takes journal and report.
        is_resumed: whether it goes on with what the journal there has; boxes and seed are those of it.
    """
    from pack_bringup.cli.outputs import make_output_folder
    from pack_core.palletizing.shift_journal import (
        JOURNAL,
        WATCHED,
        ShiftJournal,
        WrittenShift,
        read_interrupted,
    )
    from pack_lockstep.palletizing.shift_lockstep import ShiftLockstep, shift_run_setup

    setup = shift_run_setup()
    before = WrittenShift({}, ())
    if is_resumed:
        before = read_interrupted(folder / JOURNAL, setup.stream.cell.preset)
        boxes, seed = before.facts["boxes"], before.facts["seed"]
    else:
        make_output_folder(folder, taken_by=(JOURNAL,))
    facts = {"seed": seed, "boxes": boxes, "preset": setup.stream.cell.preset, WATCHED: True}
    with ShiftJournal(folder / JOURNAL, facts) as journal:

        def note(events: tuple[ShiftEvent, ...]) -> None:
            journal.write(events)
            for event in events:
                if line := _line(event):
                    typer.echo(line)

        ShiftLockstep(setup, boxes, seed, before.events).run(note)
    report = write_report(folder)
    went_wrong = ("unwanted_contacts", "fallen", "lost", "skipped")
    is_well = report["settled"] == boxes and not any(report[kind] for kind in went_wrong)
    raise typer.Exit(0 if is_well else 1)


def demo_live(
    boxes: int, seed: int, folder: Path, real_time_factor: float | None, domain: int | None,
    page: PageProcess | None,
) -> NoReturn:  # fmt: skip
    """Start the nodes, run a shift, report it, and leave with 0 if all boxes came and none was lost, else 1.

    Args:
        boxes: it ends when so many have come.
        seed: of what comes.
        folder: takes journal, report and recording.
        real_time_factor: simulated seconds a second of wall clock; None: that of the simulator's file.
        domain: ROS domain id; None: the environment's, else a free one.
        page: a page that shows the run while it goes on; None: none.
    """
    from pack_bringup.cli.outputs import command_line
    from pack_bringup.palletizing.goals import LiveShiftJob
    from pack_core.palletizing.shift_journal import JOURNAL

    job = LiveShiftJob(folder, boxes, seed, real_time_factor=real_time_factor, command=command_line())
    result, pace = run_nodes(job, domain, page, taken_by=(JOURNAL,))
    write_report(folder)
    end_live(job, result, pace)


def write_report(folder: Path) -> dict[str, Any]:
    """From the journal in its folder write the report of a shift and pictures of its pallets; sum it up."""
    from pack_bringup.cli.outputs import write_json
    from pack_core.palletizing.shift_journal import JOURNAL, read_journal
    from pack_evaluation.palletizing.drawings import draw_order
    from pack_evaluation.palletizing.shift_report import built_pallets, order_of_pallet, shift_report

    written = read_journal(folder / JOURNAL)
    report, built = shift_report(written), built_pallets(written.events)
    (folder / "pictures").mkdir(exist_ok=True)
    for number, pallet in enumerate(built, start=1):
        name = f"{number:03}_{pallet.place}"
        draw_order(order_of_pallet(pallet, name), ()).savefig(folder / "pictures" / f"{name}.png", dpi=110)
    write_json(folder / "report.json", report)
    taken = sum(pallet.taken is not None for pallet in built)
    hourly, over = report["boxes_per_hour"], report["over_table_share"]
    watched = {"unwanted_contacts": "unwanted contacts", "fallen": "boxes on the floor"}
    wrong = "".join(f"; {len(report[kind])} {words}" for kind, words in watched.items() if kind in report)
    typer.echo(
        f"{report['on_pallets']} of {report['came']} boxes on pallets, {taken} pallets "
        f"taken away, {len(report['rejected'])} boxes rejected"
        + (f"; {hourly:.0f} boxes an hour, {over:.0%} over table B" if hourly else "")
        + f"{wrong}\njournal and report: {folder}"
    )
    return report


def newest_shift() -> Path:
    """The folder of the shift that was written to last.

    Raises:
        ConfigError: there is none.
    """
    from pack_core.palletizing.shift_journal import JOURNAL
    from pack_core.paths import bags_path

    found = sorted(bags_path().glob(f"*/{JOURNAL}"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise ConfigError(f"{bags_path()} has no shift to go on with; allowed: --output with its folder")
    return found[-1].parent


def shift_goal(boxes: int, seed: int, *, is_resumed: bool, output: Path | None = None) -> ShiftGoal:
    """The goal of a shift.

    Args:
        boxes: it ends when so many have come.
        seed: of what comes on a simulated conveyor.
        is_resumed: whether a shift is gone on with; boxes and seed are those of it.
        output: folder of the journal; None: a new one, or that of the newest shift where it goes on.

    Raises:
        ConfigError: there is no shift to go on with.
    """
    from pack_bringup.palletizing.goals import ShiftGoal
    from pack_bringup.recording.run_record import default_folder

    begun = newest_shift() if is_resumed and output is None else default_folder(SHIFTS, seed, datetime.now())
    return ShiftGoal(output or begun, boxes, seed, is_resumed)


def send_shift(
    boxes: int, output: Path | None, seed: int, at: CellAddress, *, is_resumed: bool, reset: bool
) -> NoReturn:
    """Have a running cell run a shift, or go on with one, and leave as `run_goal` does.

    Args:
        boxes: it ends when so many have come.
        output: folder of the journal; None: a new one, or that of the newest shift where it goes on.
        seed: of what comes on a simulated conveyor.
        at: the cell.
        is_resumed: whether a shift is gone on with; boxes and seed are those of it.
        reset: whether the simulated cell is put into the state that the journal has, or emptied.
    """
    from pack_core.palletizing.shift_journal import JOURNAL

    wanted = shift_goal(boxes, seed, is_resumed=is_resumed, output=output)
    folder = wanted.folder

    def show(_: object) -> None:
        if (folder / JOURNAL).is_file():  # a goal that was refused has none
            write_report(folder)

    run_goal(wanted, at, reset=reset, show=show)


def _line(event: ShiftEvent) -> str:
    """An event as a line of the terminal; empty for those that only the journal has."""
    match event.kind:
        case "came":
            edges = " x ".join(f"{1e3 * edge:.0f}" for edge in event.data["size"])
            what = f"came, {edges} mm" + (f", {event.reason}" if event.reason else "")
        case "put down":
            what = f"stands on {event.place.replace('_', ' ')}"
        case "taken" if event.box:
            what = f"is taken away from the {event.place.replace('_', ' ')}"
        case "taken":
            what = f"{event.place.replace('_', ' ')} with {len(event.data['boxes'])} boxes is taken away"
        case "moved":
            what = f"is a little elsewhere: {event.reason}"
        case "fell":
            what = event.reason
        case "skipped" | "lost" | "touched" | "ended":
            what = f"{event.kind}: {event.reason}"
        case "began" if event.data["standing"]:
            what = f"goes on with {event.data['standing']} boxes that stand" + (
                f"; not as the journal says: {event.reason}" if event.reason else ""
            )
        case "state" if event.reason:
            what = f"{event.data['state']}: {event.reason}"
        case _:
            return ""
    return " ".join(filter(None, (f"{event.time:8.1f} s", event.box, what)))


def run_shift(given: ShiftOptions, options: RunOptions) -> None:
    """Place the streams and report; raises ConfigError for a value that is not allowed."""
    from pack_core.config import merged, validate_config
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.box_stream import shipped_lists
    from pack_lockstep.node_parameters import load_parameters
    from pack_lockstep.palletizing.settings import place_parameters
    from pack_lockstep.palletizing.shift import BoxStreamConfig, ShiftBenchmark, StreamJob, shift_setup
    from pack_lockstep.palletizing.shift_lockstep import PRESET
    from pack_planner.layout.layout_planner import LayoutConfig
    from pack_planner.layout.online_planner import OnlineConfig

    source = "the options of --shift"
    tipping = {} if given.tipping is None else {"tipping": {"push": given.tipping}}
    values = {
        "packer": {"rule": given.rule, **tipping}, "pallets": given.open_pallets, "buffer": given.buffer,
        "preview": given.preview,
    }  # fmt: skip
    config = validate_config(OnlineConfig, merged(place_parameters(PRESET).model_dump(), values), source)
    limits = {"max_pressure": given.max_pressure, "fragile": given.fragile}
    stream = validate_config(BoxStreamConfig, limits, source)
    jobs = tuple(StreamJob(seed) for seed in range(given.seed, given.seed + given.streams))
    if given.boxes:
        if (given.open_pallets, given.buffer, given.preview) != (2, 2, 1):
            raise ConfigError(
                f"--open-pallets {given.open_pallets}, --buffer {given.buffer}, --preview {given.preview} "
                "beside --boxes; allowed: 2, 2 and 1, as the cell of the preset shift has them"
            )
        from pack_lockstep.palletizing.shift_benchmark import MovingShiftBenchmark
        from pack_lockstep.palletizing.shift_lockstep import shift_run_setup

        moving = shift_run_setup(config, stream)
        run(MovingShiftBenchmark(moving, given.boxes, jobs), options)
        return
    insertion = load_parameters("palletizing/layout", LayoutConfig).insertion
    setup = shift_setup(shipped_lists(), palletizing_cell(), config, stream, insertion)
    run(ShiftBenchmark(setup, jobs), options)
