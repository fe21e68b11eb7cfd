"""`pack demo blocks`: blocks put into a dense grid before your eyes."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.demo_options import Output, RealTimeFactor, Video
from pack_bringup.cli.live import command_line, run_live
from pack_bringup.cli.page_options import PORT, Live, Port, page_process
from pack_bringup.recording.run_record import default_folder
from pack_core.errors import ConfigError


def demo(
    blocks: Annotated[int, typer.Option(min=1, max=25, help="Number of blocks.")] = 9,
    density: Annotated[
        float, typer.Option(min=0.01, max=0.4, help="Share of the workspace that the blocks cover.")
    ] = 0.2,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the generated problem and of the planner.")] = 0,
    problem: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Solve the problem of this file instead of a generated one."),
    ] = None,
    method: Annotated[
        str, typer.Option(help="Planner, by its name in config/nodes/blocks/rearrangement.yaml.")
    ] = "",
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PORT,
    output: Output = None,
) -> None:
    """Rearrange blocks into a dense grid: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the problem, the
    configuration and the nodes' log. The exit code is 0 only if every block is at its goal.

    - `pack demo blocks --blocks 4 --seed 3`
    - `pack demo blocks --problem config/scenarios/blocks/example.yaml --method pirs`
    """
    from pack_bringup.blocks.job import BlocksJob

    text = _text_of(problem) if problem else _generated(blocks, density, seed)
    folder = output or default_folder("blocks", seed, datetime.now())
    job = BlocksJob(folder, text, seed, method, real_time_factor, command_line())
    run_live(job, video=video, page=page_process("blocks", live, port))


def _text_of(path: Path) -> str:
    from pack_core.blocks.problem_file import parse_problem

    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    text = path.read_text()
    parse_problem(text, str(path))
    return text


def _generated(blocks: int, density: float, seed: int) -> str:
    from pack_core.blocks.cell import blocks_cell
    from pack_core.blocks.problem_file import problem_text
    from pack_planner.rearrangement.instances import make_instance

    return problem_text(make_instance(blocks, density, seed, centre=blocks_cell().workspace.centre))
