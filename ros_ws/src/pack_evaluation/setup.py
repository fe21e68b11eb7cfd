from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "pack_evaluation"

setup(
    name=package,
    version=ElementTree.parse("package.xml").findtext("version"),
    license="Apache-2.0",
    packages=find_packages(),
    package_data={
        package: ["*.j2"],
        f"{package}.packing": ["*.j2"],
        f"{package}.packing.fill": ["*.j2"],
        f"{package}.palletizing": ["*.j2"],
        f"{package}.blocks": ["*.j2"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
)
