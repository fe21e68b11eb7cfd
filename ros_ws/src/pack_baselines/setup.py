from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_baselines"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    # What the registers of the shipped packages find (pack_core/register.py).
    entry_points={
        "pack_mpc.optimizers": [
            "ilqr = pack_baselines.ilqr.ilqr_optimizer:IlqrOptimizer",
            "judo = pack_baselines.judo_optimizer:JudoOptimizer",
        ],
        "pack_planner.placement_planners": [
            "algorithm_1_literal = pack_baselines.literal_planner:LiteralPlanner",
            "random = pack_baselines.random_pose_planner:RandomPosePlanner",
        ],
        "pack_planner.insertion_rules": ["longest = pack_baselines.thesis.longest_corridor:longest_corridor"],
        "pack_planner.separators": ["pairwise = pack_baselines.thesis.pairwise_separator:PairwiseSeparator"],
        "pack_perception.locators": [
            "rectangle = pack_baselines.thesis.rectangle_locator:locate_by_rectangle"
        ],
        "pack_planner.rearrangement_planners": ["pirs = pack_baselines.pirs.pirs_planner:PirsPlanner"],
    },
)
