"""URDF texts as robot descriptions, without a file."""

from pathlib import Path

from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader


def parse_urdf(text: str, file: Path | None = None) -> RobotDescription:
    return describe_urdf(XmlReader(text, file), text)
