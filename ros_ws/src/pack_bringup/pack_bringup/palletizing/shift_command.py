"""`pack benchmark palletizing --shift`: its options, and the streams of boxes that they ask for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from pack_bringup.cli.benchmark_run import RunOptions, run
from pack_core.errors import ConfigError
from pack_core.paths import config_path

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
    """The options of a shift, as the command line has them."""

    streams: int
    seed: int
    rule: str
    buffer: int
    preview: int
    open_pallets: int
    tipping: float | None
    max_pressure: float | None
    fragile: float


def refuse(others: Mapping[str, Any]) -> None:
    """Raise ConfigError where options are given, by name, that are for orders."""
    if given_too := [name for name, value in others.items() if value]:
        raise ConfigError(
            f"{', '.join(given_too)} beside --shift; allowed: --streams, --seed, what its help says is for "
            "--shift, and the options of every benchmark; the rest is for orders"
        )


def run_shift(given: ShiftOptions, options: RunOptions) -> None:
    """Place the streams and report; raises ConfigError for a value that is not allowed."""
    from pack_core.config import validate_config
    from pack_core.palletizing.cell import palletizing_cell
    from pack_lockstep.node_parameters import load_parameters
    from pack_lockstep.palletizing.shift import BoxStreamConfig, ShiftBenchmark, StreamJob, shift_setup
    from pack_planner.layout.layout_planner import LayoutConfig
    from pack_planner.layout.online_planner import OnlineConfig

    source = "the options of --shift"
    tipping = {} if given.tipping is None else {"tipping": {"push": given.tipping}}
    values = {
        "packer": {"rule": given.rule, **tipping}, "pallets": given.open_pallets, "buffer": given.buffer,
        "preview": given.preview,
    }  # fmt: skip
    config = validate_config(OnlineConfig, values, source)
    limits = {"max_pressure": given.max_pressure, "fragile": given.fragile}
    stream = validate_config(BoxStreamConfig, limits, source)
    insertion = load_parameters("palletizing/layout", LayoutConfig).insertion
    files = sorted(config_path("item_lists").glob("*.csv"))
    setup = shift_setup(files, palletizing_cell(), config, stream, insertion)
    jobs = tuple(StreamJob(seed) for seed in range(given.seed, given.seed + given.streams))
    run(ShiftBenchmark(setup, jobs), options)
