"""`pack demo packing`: one object packed before your eyes."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

import typer

from pack_bringup.cli.demo_options import Domain, Output, RealTimeFactor, Video
from pack_bringup.cli.live import command_line, run_live
from pack_bringup.cli.page_options import PORT, Live, Port, page_process
from pack_bringup.packing.goal_command import Fill, ListFile, Method, SceneFile, Seed, check_scene, is_fill
from pack_bringup.recording.run_record import default_folder
from pack_core.packing.method import PackingMethod


def demo(
    seed: Seed = 0,
    scene: SceneFile = None,
    method: Method = PackingMethod.PACK_IT_IN,
    preset: Annotated[
        str,
        typer.Option(
            help="Run under the conditions of this file of config/presets (docs/cells/packing/presets.md)."
        ),
    ] = "",
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    fill: Fill = False,
    given: ListFile = None,
    live: Live = False,
    port: Port = PORT,
    output: Output = None,
    domain: Domain = None,
) -> None:
    """Pack one object: five nodes, one goal, and a report at the end.

    The container has no free place for the object, so the arm makes one by pushing. The run's folder then
    holds the recording (bag/), report.html, plots/, run.mp4, the scene, the configuration and the nodes' log.
    The exit code is 0 only if the object was packed.

    - `pack demo packing --seed 3`
    - `pack demo packing --method uninformed_pose --no-video`
    - `pack demo packing --preset hardware`
    - `pack demo packing --scene config/scenarios/packing/example.yaml --real-time-factor 0.3`
    - `pack demo packing --fill config/packing_lists/example.yaml`
    """
    from pack_bringup.packing.job import PackingJob

    check_scene(scene)
    folder = output or default_folder("packing", seed, datetime.now())
    job: PackingJob
    if is_fill(fill, given, scene, method):
        from pack_bringup.packing.fill_job import packing_fill_job

        job = packing_fill_job(
            seed, given, folder=folder, real_time_factor=real_time_factor, command=command_line(),
            preset=preset,
        )  # fmt: skip
    else:
        job = PackingJob(
            seed, scene, method.value, folder=folder, real_time_factor=real_time_factor,
            command=command_line(), preset=preset,
        )  # fmt: skip
    run_live(job, video=video, domain=domain, page=page_process("packing", live, port))
