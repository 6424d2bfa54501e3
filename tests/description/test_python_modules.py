"""Where a ROS package keeps its Python modules: by its setup.py, its setup.cfg or its CMakeLists.txt."""

from pathlib import Path

import pytest

from drake_twin.description.python_modules import module_spec, python_modules
from drake_twin.description.python_programs import python_programs

SETUP = "from setuptools import find_packages, setup\nsetup(name='arm', {})\n"
ENTRY = "entry_points={'console_scripts': ['move = mover.move:main']}"


def write(folder: Path, name: str, text: str = "") -> Path:
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return file


@pytest.fixture
def package(tmp_path):
    """A package of the name ``arm``."""
    write(tmp_path, "arm/package.xml", "<package><name>arm</name></package>")
    return tmp_path / "arm"


@pytest.mark.parametrize(
    ("said", "place"),
    [
        ("packages=['mover'], " + ENTRY, "mover"),
        ("packages=find_packages('src'), package_dir={'': 'src'}, " + ENTRY, "src/mover"),
        ("packages=find_packages(where='py'), package_dir={'': 'py'}, " + ENTRY, "py/mover"),
        ("packages=['mover'], package_dir={'mover': 'python/code'}, " + ENTRY, "python/code"),
    ],
)
def test_a_setup_py(package, said, place):
    write(package, "setup.py", SETUP.format(said))
    file = write(package, f"{place}/move.py", "def main(): pass\n")
    write(package, f"{place}/__init__.py")
    assert python_modules(package)["mover"] == package / place
    found = python_programs(package)["move"]
    assert (found.file, found.module, found.function) == (file, "mover.move", "main")
    spec = module_spec("mover", [package])
    assert spec.origin == str(package / place / "__init__.py")
    assert list(spec.submodule_search_locations) == [str(package / place)]


def test_a_setup_cfg(package):
    write(package, "setup.py", "from setuptools import setup\nsetup()\n")
    write(package, "setup.cfg", "[options]\npackage_dir =\n    = src\npackages = find:\n")
    write(package, "src/mover/__init__.py")
    assert python_modules(package) == {"mover": package / "src/mover"}


def test_a_module_outside_of_packages(package):
    write(package, "setup.py", SETUP.format("py_modules=['reach', 'absent']"))
    file = write(package, "reach.py")
    assert python_modules(package) == {"reach": file}
    assert module_spec("reach", [package]).origin == str(file)


@pytest.mark.parametrize(
    ("command", "name", "place"),
    [
        ("ament_python_install_package(${PROJECT_NAME})", "arm", "arm"),
        ("ament_python_install_package(${PROJECT_NAME} PACKAGE_DIR python/arm_py)", "arm", "python/arm_py"),
        ("ament_python_install_package(mover PACKAGE_DIR ${PROJECT_SOURCE_DIR}/code)", "mover", "code"),
    ],
)
def test_a_cmake_list(package, command, name, place):
    write(package, "CMakeLists.txt", f"project(arm)\nfind_package(ament_cmake_python REQUIRED)\n{command}\n")
    write(package, f"{place}/__init__.py")
    assert python_modules(package) == {name: package / place}


def test_a_cmake_list_with_a_module(package):
    write(package, "CMakeLists.txt", "project(arm)\nament_python_install_module(lib/reach.py)\n")
    file = write(package, "lib/reach.py")
    assert python_modules(package) == {"reach": file}


def test_an_installed_package(tmp_path):
    write(tmp_path, "share/arm/package.xml", "<package><name>arm</name></package>")
    file = write(tmp_path, "lib/python3.12/site-packages/arm/__init__.py")
    assert python_modules(tmp_path / "share/arm") == {"arm": file.parent}
