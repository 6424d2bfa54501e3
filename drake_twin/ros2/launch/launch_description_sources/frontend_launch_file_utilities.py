"""XML and YAML launch files: their text, and the launch description of their elements."""

from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_description import LaunchDescription

__all__: list[str] = []  # launch files find nothing of ROS's here


def read_launch_file(path: str) -> str:
    """Return the text of a launch file.

    Raises:
        InputError: If it cannot be read, or is not UTF-8.
    """
    try:
        return file_text(path, "utf-8-sig")
    except OSError as error:
        raise InputError(f"the launch file cannot be read ({error.strerror})", file=path) from None
    except UnicodeDecodeError as error:
        raise InputError(f"this is not UTF-8 text ({error.reason})", file=path) from None


def parse_description(root: Entity) -> LaunchDescription:
    """Return the launch description of a file's outermost element.

    Raises:
        InputError: If an element or attribute is unknown, missing or wrong.
    """
    if root.type_name != "launch":
        raise root.error("a launch file's outermost element is launch")
    parser = Parser()
    description = LaunchDescription([parser.parse_action(child) for child in root.children])
    description.place = root.place
    return description
