from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_bringup"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
        (f"share/{package}/hook", ["hook/loopback.dsv"]),
        (f"share/{package}/network", ["network/loopback.xml"]),
        (f"share/{package}/launch", ["launch/cell.launch.py"]),
    ],
    entry_points={
        "console_scripts": [
            "recorder_node = pack_bringup.recording.recorder_node:main",
            "foxglove_node = pack_bringup.foxglove_node:main",
            "opcua_node = pack_bringup.opcua.opcua_node:main",
            "pack = pack_bringup.cli.main:main",
        ]
    },
)
