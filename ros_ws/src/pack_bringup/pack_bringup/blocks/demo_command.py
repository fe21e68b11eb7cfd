"""`pack demo blocks`: blocks put into a dense grid before your eyes."""

from __future__ import annotations

from datetime import datetime

from pack_bringup.blocks.goal_command import Blocks, Density, Method, ProblemFile, Seed, problem_of
from pack_bringup.cli.demo_options import Domain, Output, RealTimeFactor, Video
from pack_bringup.cli.live import command_line, run_live
from pack_bringup.cli.page_options import PORT, Live, Port, page_process
from pack_bringup.recording.run_record import default_folder


def demo(
    blocks: Blocks = 9,
    density: Density = 0.2,
    seed: Seed = 0,
    problem: ProblemFile = None,
    method: Method = "",
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PORT,
    output: Output = None,
    domain: Domain = None,
) -> None:
    """Rearrange blocks into a dense grid: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the problem, the
    configuration and the nodes' log. The exit code is 0 only if every block is at its goal.

    - `pack demo blocks --blocks 4 --seed 3`
    - `pack demo blocks --problem config/scenarios/blocks/example.yaml --method pirs`
    """
    from pack_bringup.blocks.job import BlocksJob

    text = problem_of(problem, blocks, density, seed)
    folder = output or default_folder("blocks", seed, datetime.now())
    job = BlocksJob(
        text, seed, method, folder=folder, real_time_factor=real_time_factor, command=command_line()
    )
    run_live(job, video=video, domain=domain, page=page_process("blocks", live, port))
