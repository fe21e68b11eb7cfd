"""`pack demo`: one object packed before your eyes."""

from __future__ import annotations

import signal
import sys
from datetime import datetime
from enum import Enum
from pathlib import Path
from types import TracebackType
from typing import Annotated, Any, Self

import typer
from rich.console import Console
from rich.live import Live
from rich.text import Text

from pack_bringup.cli.evaluate import run_evaluation, show
from pack_bringup.demo import LOG, Demo, Progress, run_demo
from pack_bringup.run_record import default_folder

app = typer.Typer()


class Method(Enum):
    """The methods that the paper compares."""

    PACK_IT_IN = "pack_it_in"
    UNINFORMED_POSE = "uninformed_pose"
    UNINFORMED_PHYSICS = "uninformed_physics"


@app.command()
def demo(
    cell: Annotated[str, typer.Argument(help="A graph of config/graphs.")] = "packing",
    seed: Annotated[int, typer.Option(min=0, help="Of the scene, the noise and the plan.")] = 0,
    scene: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="An own scene (docs/scenes.md), not a generated one."),
    ] = None,
    method: Annotated[
        Method, typer.Option(help="The paper's method, or one of its baselines.")
    ] = Method.PACK_IT_IN,
    preset: Annotated[str, typer.Option(help="Conditions: a file of config/presets (docs/presets.md).")] = "",
    real_time_factor: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            help="Simulated seconds a second; 0: as fast as it can. Default: config/nodes/sim.yaml.",
        ),
    ] = None,
    video: Annotated[bool, typer.Option(help="Render the run as MP4.")] = True,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="The run's folder; one below bags/ if not given."),
    ] = None,
) -> None:
    """Pack one object: five nodes, one goal, and a report at the end.

    The container has no free place for the object, so the arm makes one by pushing. The run's folder then
    holds the recording (bag/), report.html, plots/, run.mp4, the scene, the configuration and the nodes' log.
    The exit code is 0 only if the object was packed.

    - `pack demo packing --seed 3`
    - `pack demo packing --method uninformed_pose --no-video`
    - `pack demo packing --preset hardware`
    - `pack demo packing --scene config/scenarios/example.yaml --real-time-factor 0.3`
    """
    if scene:
        _check_scene(scene)
    folder = output or default_folder(cell, seed, datetime.now())
    command = " ".join(["pack", *sys.argv[1:]])
    job = Demo(cell, folder, seed, scene, method.value, real_time_factor, command, preset)
    signal.signal(signal.SIGTERM, _as_ctrl_c)
    try:
        with LiveLine() as line:
            result = run_demo(job, line.show)
    except KeyboardInterrupt:
        typer.echo(f"stopped; what was recorded is in {folder}")
        raise typer.Exit(130) from None
    typer.echo(f"goal ended: {result.exit_reason}, {result.message}")
    show(run_evaluation(folder, folder, with_video=video))
    typer.echo(f"log:    {folder / LOG}")
    raise typer.Exit(0 if result.success else 1)


class LiveLine:
    """One line that is kept up to date; where there is no terminal, a line for every stage."""

    def __init__(self) -> None:
        self._console = Console()
        self._live = Live(console=self._console, refresh_per_second=8, transient=False)
        self._stage: str | None = None

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.stop()

    def show(self, progress: Progress) -> None:
        """Show the newest progress."""
        line = describe(progress)
        if self._console.is_terminal:
            self._live.update(Text(line))
        elif progress.stage != self._stage:
            self._console.print(line, soft_wrap=True)
        self._stage = progress.stage


def describe(progress: Progress) -> str:
    """Progress as one line."""
    if not progress.stage:
        return f"waiting for {', '.join(progress.missing) or 'the first plan'}"
    return (
        f"{progress.stage:9} {progress.elapsed:5.1f} s   distance {100 * progress.distance:5.1f} cm   "
        f"iteration {progress.iteration_ms:5.0f} ms   real-time factor {progress.real_time_factor:4.2f}"
    )


def _check_scene(path: Path) -> None:
    from pack_core.scene.scene_file import load_scene

    load_scene(path)


def _as_ctrl_c(*_: Any) -> None:
    raise KeyboardInterrupt
