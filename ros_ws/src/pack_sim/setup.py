from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_sim"

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
            "blocks_sim_node = pack_sim.blocks.blocks_sim_node:main",
            "effort_relay_node = pack_sim.packing.effort_relay_node:main",
            "sim_node = pack_sim.packing.sim_node:main",
            "pallet_sim_node = pack_sim.palletizing.pallet_sim_node:main",
        ]
    },
)
