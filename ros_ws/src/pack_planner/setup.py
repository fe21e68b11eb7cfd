from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_planner"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    entry_points={
        "console_scripts": [
            "layout_node = pack_planner.layout.layout_node:main",
            "planner_node = pack_planner.placement.planner_node:main",
            "rearrangement_node = pack_planner.rearrangement.rearrangement_node:main",
        ]
    },
)
