"""Where what a node program lacks may come from: a module, or ROS's own command."""

import re
from pathlib import Path
from xml.etree import ElementTree

from drake_twin.description.package_index import containing_package
from drake_twin.description.source_file import file_bytes, file_text
from drake_twin.messages import interface_types
from drake_twin.nodes.stand_ins import ROOTS

_INTERFACES = ("_actions", "_interface", "_interfaces", "_msg", "_msgs", "_srv", "_srvs")
# Module → its distribution in the package index, where the two names differ or ROS installs it otherwise.
_DISTRIBUTIONS = {
    "PIL": "pillow",
    "cv2": "opencv-python-headless",
    "paho": "paho-mqtt",
    "ros2_numpy": "ros2-numpy",
    "serial": "pyserial",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "usb": "pyusb",
    "yaml": "pyyaml",
    **{
        name: name
        for name in (
            "bresenham",
            "dearpygui",
            "matplotlib",
            "pandas",
            "py_trees",
            "pynput",
            "scipy",
            "torch",
            "transforms3d",
            "ultralytics",
        )
    },
}

# ROS packages that the twin does not bring → where they are on GitHub. Those that are Python run from a workspace.
_SOURCES = {
    "camera_info_manager": "ros-perception/image_common",
    "diagnostic_updater": "ros/diagnostics",
    "irobot_create_msgs": "iRobotEducation/irobot_create_msgs",
    "launch_testing": "ros2/launch",
    "px4_msgs": "PX4/px4_msgs",
    "py_trees_ros": "splintered-reality/py_trees_ros",
    "py_trees_ros_interfaces": "splintered-reality/py_trees_ros_interfaces",
    "python_qt_binding": "ros-visualization/python_qt_binding",
    "qt_gui": "ros-visualization/qt_gui_core",
    "rqt_gui": "ros-visualization/rqt",
    "rqt_gui_py": "ros-visualization/rqt",
    "ur_dashboard_msgs": "UniversalRobots/Universal_Robots_ROS2_Driver",
    "ur_msgs": "ros-industrial/ur_msgs",
    **{f"ros2{name}": "ros2/ros2cli" for name in ("action", "lifecycle", "node", "param", "pkg", "run", "service")},
}
# Those that are C++, and what there is instead.
_OF_C = {
    "moveit": "send goals to /move_action, see the page on nodes",
    "PyKDL": "use transforms3d or NumPy",
    "tf2_kdl": "use tf2_geometry_msgs",
}
_FOLDER = ": give the folder of this ROS package by --package-path"
_COMPILERS = frozenset(("pybind11_add_module", "Python3_add_library", "Python_add_library", "nanobind_add_module"))


def remedy(error: BaseException, file: Path) -> str:
    """Return what may be done about an error; empty if nothing is known, or nothing is missing.

    Args:
        error: The error.
        file: The program's script, whose package says what it depends on.
    """
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return ""
    root, _, rest = error.name.partition(".")
    if rest in ("msg", "srv", "action"):
        return f": the package has no .{rest} files"
    if rest and _is_compiled(error):
        return ": it has to be compiled from C++, as the CMakeLists.txt of its package says"
    if rest and root in ROOTS:
        return f": the twin's own {root} does not have this module"
    if rest or root in ROOTS | interface_types.known_packages():
        return ""
    if root in _DISTRIBUTIONS:
        return f": pip install {_DISTRIBUTIONS[root]}"
    if root in _SOURCES:
        return f"{_FOLDER}; it is in {_SOURCES[root]} on GitHub"
    if root in _OF_C:
        return f": ROS's is compiled from C++, and the twin does not have it: {_OF_C[root]}"
    return _FOLDER if root in _dependencies(file) or root.endswith(_INTERFACES) else ""


def _is_compiled(error: ModuleNotFoundError) -> bool:
    """Return whether the package that asks for a missing module makes compiled modules, as by pybind11."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    package = None if trace is None else containing_package(Path(trace.tb_frame.f_code.co_filename))
    try:
        text = "" if package is None else file_text(package / "CMakeLists.txt", errors="replace")
    except OSError:
        return False
    words = set(re.findall(r"\w+", text))
    return (error.name or "").rpartition(".")[2] in words and not _COMPILERS.isdisjoint(words)


def _dependencies(file: Path) -> set[str]:
    """Return what the package of a script depends on."""
    package = containing_package(file)
    try:
        tags = [] if package is None else [*ElementTree.fromstring(file_bytes(package / "package.xml"))]
    except (OSError, ElementTree.ParseError):
        return set()
    return {(tag.text or "").strip() for tag in tags if tag.tag.endswith("depend")}
