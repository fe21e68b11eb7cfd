from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_perception"

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
            "box_vision_node = pack_perception.boxes.box_vision_node:main",
            "perception_node = pack_perception.mocap.perception_node:main",
            "tag_perception_node = pack_perception.tags.tag_perception_node:main",
        ]
    },
)
