"""Small launch files, written and evaluated in a test."""

from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.findings import Kind
from drake_twin.ros2.evaluate import evaluate
from drake_twin.ros2.launched import Launched
from drake_twin.scenario import Scenario

_PYTHON = """\
import os
from launch import *
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *
from launch_ros.substitutions import FindPackagePrefix, FindPackageShare, ExecutableInPackage
from ament_index_python.packages import get_package_share_directory

{before}

def generate_launch_description():
    return LaunchDescription([
{entities}
    ])
"""


def write(file: Path, text: str) -> Path:
    """Writes a file and the folders above it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return file


def write_python(file: Path, entities: str, before: str = "") -> Path:
    """Writes a Python launch file with these entities."""
    return write(file, _PYTHON.format(entities=entities, before=before))


def write_package(folder: Path, name: str) -> Path:
    """Writes a package's package.xml; returns its folder."""
    write(folder / name / "package.xml", f"<package format='3'><name>{name}</name></package>")
    return folder / name


def launch_python(folder: Path, entities: str, before: str = "", **arguments: str) -> Launched:
    """Evaluates a Python launch file with these entities."""
    return evaluate(write_python(folder / "test.launch.py", entities, before), arguments, PackageIndex([folder]))


def launch_xml(folder: Path, elements: str, **arguments: str) -> Launched:
    """Evaluates an XML launch file with these elements."""
    return evaluate(
        write(folder / "test.launch.xml", f"<launch>\n{elements}\n</launch>"), arguments, PackageIndex([folder])
    )


def value_of(folder: Path, substitution: str, before: str = "", **arguments: str) -> str:
    """The text of a substitution, written in Python."""
    launched = launch_python(folder, f"LogInfo(msg={substitution})", before, **arguments)
    return launched.log[-1]


def not_started(scenario: Scenario, kind: Kind = Kind.NOT_STARTED) -> tuple[str, ...]:
    """What a launch file asks for and the twin does not start."""
    return tuple(item.what for item in scenario.findings if item.kind is kind)
