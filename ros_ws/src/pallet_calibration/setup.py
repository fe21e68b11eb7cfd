from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pallet_calibration"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
)
