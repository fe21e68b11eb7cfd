from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_viewer"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    entry_points={"console_scripts": ["live_node = pack_viewer.live_node:main"]},
)
