from setuptools import find_packages, setup

package = "pack_core"

setup(
    name=package,
    version="0.1.0",
    license="Apache-2.0",
    packages=find_packages(),
    package_data={
        "pack_core.evaluation": ["*.j2"],
        "pack_core.evaluation.study": ["*.j2"],
        "pack_core.evaluation.palletizing": ["*.j2"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
)
