"""The palletizing cell on the command line: goal, demo, benchmark, and `pack layout` and `pack states`."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_run import RunOptions, run
from pack_bringup.cli.options import (
    BenchmarkFolder,
    CellAddress,
    Domain,
    FreeDomain,
    Fresh,
    Jobs,
    JsonFile,
    Live,
    Namespace,
    Network,
    Port,
    Ray,
    RealTimeFactor,
    Reset,
    RunFolder,
    Video,
    page_process,
)
from pack_bringup.cli.outputs import check_json_file, command_line, make_output_folder
from pack_bringup.cli.pursue import run_goal, run_live
from pack_bringup.palletizing import calibration, order_command, shift_command
from pack_bringup.palletizing.shift_command import BOXES, DEFAULTS
from pack_bringup.recording.run_record import default_folder
from pack_core.addresses import PAGE_PORT
from pack_core.errors import ConfigError
from pack_core.paths import config_path

OrderFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Order to build. Default: order_03.json of config/orders."),
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of where each box arrives on the picking table.")]
ProfileName = Annotated[
    str,
    typer.Option(help="`blended` moves through; `thesis` stops at each state. Default: that of fsm.yaml."),
]
Calibrate = Annotated[
    bool, typer.Option("--calibrate", help="Find out where everything in the cell is, instead of an order.")
]
Check = Annotated[
    bool, typer.Option("--check", help="Test the calibration that the cell was started with, instead.")
]
CalibrationFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="With --calibrate: takes calibration.yaml and plots; with --shift: journal and report.",
    ),
]


def goal(
    order: OrderFile = None,
    seed: Seed = 0,
    profile: ProfileName = "",
    calibrate: Calibrate = False,
    check: Check = False,
    shift: shift_command.ShiftGoalOption = False,
    boxes: shift_command.Boxes = BOXES,
    resume: shift_command.ResumeNewest = False,
    output: CalibrationFolder = None,
    reset: Reset = True,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
) -> None:
    """Have a running cell build the pallet of one order, run a shift, or calibrate itself.

    The exit code is 0 if every box was placed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the
    goal. --reset puts the boxes of a shift that is gone on with into a simulated cell, as the journal has
    them; --no-reset is for a cell in which they still stand.

    - `pack goal palletizing --order config/orders/order_16.json`
    - `pack goal palletizing --profile thesis --domain 7`
    - `pack goal palletizing --calibrate --output /tmp/cell3`, of a cell under `--preset real`
    - `pack goal palletizing --check`, of a cell that was started with `--calibration FILE`
    - `pack goal palletizing --shift --boxes 50`, of a cell under `--preset shift`
    - `pack goal palletizing --shift --resume`, after a kill or a power cut
    """
    from pack_bringup.palletizing.goals import PalletizingGoal

    _refuse_beside(order, profile, calibrate=calibrate, check=check, shift=shift)
    at = CellAddress(domain, namespace, network)
    if shift:
        shift_command.send_shift(boxes, output, seed, at, is_resumed=resume, reset=reset)
    kept = output is not None and not (calibrate or check)  # an order is recorded by the cell's own nodes
    shift_command.require_shift({"--resume": resume, "--boxes": boxes != BOXES, "--output": kept})
    if calibrate or check:
        calibration.send_calibration(check, output, seed, at, reset=reset)
    wanted = PalletizingGoal(checked_order(order, profile), seed, profile)
    run_goal(wanted, at, reset=reset)


def _refuse_beside(order: Path | None, profile: str, *, calibrate: bool, check: bool, shift: bool) -> None:
    """Raise ConfigError for options of which only one can be."""
    given = {"--calibrate": calibrate, "--check": check, "--shift": shift, "--order": order}
    names = [name for name, value in given.items() if value]
    if profile and names and names != ["--order"]:
        names.append("--profile")
    if len(names) > 1:
        raise ConfigError(f"{' beside '.join(names)}; allowed: one of them")


def checked_order(order: Path | None, profile: str) -> Path:
    """The order's file, once it and the profile were found to be possible; raises PackError."""
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import load_order
    from pallet_fsm.states import profile_of

    file = order or config_path("orders", "order_03.json")
    load_order(file, palletizing_cell())
    if profile:
        profile_of(profile)
    return file


def demo(
    order: OrderFile = None,
    seed: Seed = 0,
    profile: ProfileName = "",
    visitors: Annotated[
        str,
        typer.Option(help="Who comes near the arm: a file of config/visitors, or `random`. Default: nobody."),
    ] = "",
    preset: Annotated[
        str,
        typer.Option(help="Conditions by name, e.g. `real`: its file is in config/presets."),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Calibration of the cell; `pack calibrate palletizing` makes it."),
    ] = None,
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PAGE_PORT,
    shift: shift_command.ShiftDemo = False,
    boxes: shift_command.Boxes = BOXES,
    resume: shift_command.Resume = None,
    output: RunFolder = None,
    domain: FreeDomain = None,
) -> None:
    """Build the pallet of one order: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the configuration and the
    nodes' log. The exit code is 0 only if every box was placed. Presets are described in
    docs/cells/palletizing/presets.md.

    With --shift there are no nodes, unless --live: a shift runs on simulated time, as fast as it can. Boxes
    come on a conveyor in a sequence that nobody knows, are measured, and go to one of two pallets. The folder
    has the journal and report.json; the exit code is 0 only if all came and nothing was lost, skipped or
    touched.

    - `pack demo palletizing --order config/orders/order_16.json`
    - `pack demo palletizing --profile thesis --no-video`
    - `pack demo palletizing --visitors person --live`
    - `pack demo palletizing --preset real --seed 3 --calibration /tmp/cell3/calibration.yaml`
    - `pack demo palletizing --shift --boxes 50 --seed 1000 --output /tmp/shift`
    - `pack demo palletizing --shift --resume /tmp/shift`, after a kill or a power cut
    """
    if shift:
        shift_command.refuse(
            {
                "--order": order, "--profile": profile, "--visitors": visitors, "--preset": preset,
                "--calibration": calibration, "--domain": domain is not None and not live,
                "--live (with --resume)": live and resume is not None,
                "--real-time-factor": real_time_factor is not None and not live, "--no-video": not video,
            },
            "--boxes, --seed, --output, --resume, --live",
        )  # fmt: skip
        folder = resume or output or default_folder(shift_command.SHIFTS, seed, datetime.now())
        if live:
            page = page_process("palletizing", live, port)
            shift_command.demo_live(boxes, seed, folder, real_time_factor, domain, page)
        shift_command.demo_shift(boxes, seed, folder, is_resumed=resume is not None)
        return
    shift_command.require_shift({"--resume": resume, "--boxes": boxes != BOXES})
    from pack_bringup.palletizing.goals import PalletizingJob
    from pack_sim.palletizing.crossings import visitors_of

    file = checked_order(order, profile)
    visitors_of(visitors, seed)
    folder = output or default_folder("palletizing", seed, datetime.now(), preset)
    job = PalletizingJob(
        file, seed, profile, folder=folder, real_time_factor=real_time_factor, command=command_line(),
        visitors=visitors, preset=preset, calibration=calibration,
    )  # fmt: skip
    run_live(job, video=video, domain=domain, page=page_process("palletizing", live, port))


def benchmark(
    orders: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Build every order file of this folder. Default: config/orders."),
    ] = None,
    order: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Build the order of this file instead; may be repeated."),
    ] = None,
    seeds: Annotated[
        int, typer.Option(min=1, help="Number of runs of each order, with the seeds 0, 1, 2, ...")
    ] = 1,
    profile: Annotated[
        str,
        typer.Option(
            help="`blended` moves through; `thesis` stops and checks at each state. Default: the preset's."
        ),
    ] = "",
    motion: Annotated[
        str,
        typer.Option(help="Gains of the motion, a file of config/motion. Default: the preset's."),
    ] = "",
    preset: Annotated[
        str,
        typer.Option(help="Conditions: name of a file of config/presets. `rigid`: as configured."),
    ] = "rigid",
    vision: Annotated[
        bool,
        typer.Option(
            help="Find boxes in rendered pictures, or (--no-vision) take true poses with added noise."
        ),
    ] = True,
    limits: Annotated[
        bool | None,
        typer.Option(
            "--limits/--no-limits",
            help="Keep the limits of joints and grip, or simulate without. Default: the preset's.",
        ),
    ] = None,
    visitors: Annotated[
        str,
        typer.Option(
            help="Who comes near the arm: a file of config/visitors, or `random` ones, drawn from each seed."
        ),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Calibration of the cell. Default: under `real` each seed's cell is calibrated first.",
        ),
    ] = None,
    calibrate: Annotated[
        bool, typer.Option(help="Calibrate first where the preset needs it, or (--no-calibrate) do without.")
    ] = True,
    gap: Annotated[
        float | None, typer.Option(metavar="MM", min=0.0, help="Between neighbours. Default: the preset's.")
    ] = None,
    first_seed: Annotated[int, typer.Option(min=0, help="The first of the seeds.")] = 0,
    plots: Annotated[
        bool,
        typer.Option(
            "--plots", help="Keep each run's figures and trajectories (JSON) in plots/ beside the results."
        ),
    ] = False,
    shift: shift_command.Shift = False,
    streams: shift_command.Streams = DEFAULTS.streams,
    seed: shift_command.FirstStream = DEFAULTS.seed,
    rule: shift_command.Rule = DEFAULTS.rule,
    buffer: shift_command.Buffer = DEFAULTS.buffer,
    preview: shift_command.Preview = DEFAULTS.preview,
    open_pallets: shift_command.OpenPallets = DEFAULTS.open_pallets,
    tipping: shift_command.Tipping = DEFAULTS.tipping,
    max_pressure: shift_command.MaxPressure = DEFAULTS.max_pressure,
    fragile: shift_command.Fragile = DEFAULTS.fragile,
    boxes: shift_command.BoxesMoved = DEFAULTS.boxes,
    jobs: Jobs = 1,
    ray: Ray = None,
    output: BenchmarkFolder = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Build many orders without ROS, on simulated time, and report how it went.

    With --shift boxes come in a sequence that is not known, and each is placed on one of the open pallets or
    set aside; no arm moves unless --boxes is given. Closed pallets are pushed in physics.

    Results repeat bit for bit, whatever the number of jobs, and are kept as they come: the same command
    goes on where it was interrupted, and --fresh measures anew.

    - `pack benchmark palletizing --seeds 5 --jobs 2 --no-vision`
    - `pack benchmark palletizing --order config/orders/order_03.json`
    - `pack benchmark palletizing --orders config/orders --json summary.json`
    - `pack benchmark palletizing --visitors random --no-vision --seeds 2`
    - `pack benchmark palletizing --preset real --seeds 5`
    - `pack benchmark palletizing --preset thesis --plots`
    - `pack benchmark palletizing --shift --streams 30 --seed 7000 --json shift.json`
    - `pack benchmark palletizing --shift --boxes 100 --streams 2 --seed 1000 --jobs 2 --json moved.json`
    """
    options = RunOptions(jobs, ray, output, fresh, json_file)
    stream = shift_command.ShiftOptions(
        streams, seed, rule, buffer, preview, open_pallets, tipping, max_pressure, fragile, boxes
    )
    if shift:
        shift_command.refuse(
            {
                "--orders": orders, "--order": order, "--seeds": seeds != 1, "--first-seed": first_seed,
                "--profile": profile, "--motion": motion, "--preset": preset != "rigid", "--plots": plots,
                "--no-vision": not vision, "--limits": limits is not None, "--visitors": visitors,
                "--calibration": calibration, "--no-calibrate": not calibrate, "--gap": gap is not None,
            },
            "--streams, --seed, what its help says is for --shift, and the options of every benchmark",
        )  # fmt: skip
        shift_command.run_shift(stream, options)
        return
    shift_command.require_shift(stream.given())
    from pack_bringup.palletizing.calibration import calibrations_for
    from pack_core.paths import config_path
    from pack_lockstep.palletizing.benchmark import PalletBenchmark, order_files, order_jobs
    from pack_lockstep.palletizing.settings import set_up

    setup = set_up(
        profile=profile, motion=motion, preset=preset, vision=vision, visitors=visitors, gap_mm=gap,
        has_limits=limits,
    )  # fmt: skip
    files = list(dict.fromkeys(order or ())) or order_files(orders or config_path("orders"))
    wanted = order_jobs(files, seeds, setup.cell, first_seed)
    numbers = range(first_seed, first_seed + seeds)
    if calibrate or calibration is not None:
        setup = calibrations_for(setup, numbers, calibration, output, fresh=fresh)
    run(PalletBenchmark(setup, tuple(wanted), plots), options)


app = typer.Typer()


@app.command()
def states() -> None:
    """Show the states of the palletizing cell and what leads from one to the next, as Markdown.

    - `pack states > docs/cells/palletizing/states.md`
    """
    from pallet_fsm.drawing import states_page

    typer.echo(states_page(), nl=False)


@app.command()
def layout(
    order: Annotated[Path, typer.Argument(metavar="ORDER", help="An order file, e.g. of config/orders.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures.")
    ] = Path("bags/layout"),
    preset: Annotated[str, typer.Option(help="Conditions by name: its file is in config/presets.")] = "rigid",
    json_file: Annotated[
        Path | None,
        typer.Option(
            "--json",
            metavar="FILE",
            help="Also write the order with its boxes at their new places.",
            callback=check_json_file,
        ),
    ] = None,
) -> None:
    """Plan the layout of an order and draw it: every layer with its gaps, and each box's way in.

    Nothing is simulated. The planner's parameters are those of config/nodes/palletizing/layout.yaml. What
    --json writes is an order file: places with gaps, in the sequence of placing, and where boxes come from.

    - `pack layout config/orders/order_03.json --output /tmp/layout`
    - `pack layout config/orders/order_03.json --preset thesis --json /tmp/order_03_parted.json`
    """
    make_output_folder(output)
    from pack_core.errors import OrderError
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.layout_plan import LayoutStatus, laid_out
    from pack_core.palletizing.orders.order_file import load_order
    from pack_evaluation.palletizing.drawings import write_pictures
    from pack_lockstep.palletizing.settings import set_up
    from pack_planner.layout.layout_planner import LayoutPlanner

    given = load_order(order, palletizing_cell())
    plan = LayoutPlanner(set_up(preset=preset).layout).plan(given)
    if plan.status is not LayoutStatus.SUCCESS:
        raise OrderError(f"{order}: no layout: {plan.reason}")
    for path in write_pictures(given, plan, output):
        typer.echo(str(path))
    if json_file is not None:
        json_file.write_text(laid_out(given, plan).model_dump_json(indent=1, exclude_none=True) + "\n")
        typer.echo(str(json_file))


APPS = (app, order_command.app)
"""Commands of `pack` that only the palletizing cell has."""
