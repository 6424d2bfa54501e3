"""What Gazebo's drive plugins become in the twin: controllers of ros2_controllers with the plugins' parameters.

Many robots have no ``<ros2_control>`` and are driven by a plugin alone. Each plugin becomes a controller of the type
that does the same, a record of the topics that it uses in place of the controller's own, and of the actuators that it
needs. Sources: ``gazebo_plugins`` of gazebo_ros_pkgs (branch ros2) and ``src/systems`` of gz-sim.
"""

from collections.abc import Iterator
from dataclasses import replace

from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.gazebo_drive import (
    GAZEBO_PLUGINS,
    PLANAR_INTERFACES,
    ROLLER_WHEELS,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
)
from drake_twin.description.gazebo_plugins import is_ros2_control, plugin_kind, plugin_node_name
from drake_twin.description.robot_description import GazeboPlugin, RobotDescription
from drake_twin.description.roller_wheels import roller_wheels
from drake_twin.errors import TwinError, described

_ROS2_CONTROL = ("gz_ros2_control-system", "libgz_ros2_control-system.so", "libgazebo_ros2_control.so")


def is_drive(plugin: GazeboPlugin) -> bool:
    """Tell whether a plugin is of a kind that becomes a controller."""
    return not is_ros2_control(plugin) and plugin_kind(plugin) in GAZEBO_PLUGINS


def known_libraries() -> list[str]:
    """Return the libraries of Gazebo's plugins that the twin knows, in their usual spelling."""
    drives = [kind if "gazebo_ros" not in kind else f"lib{kind}.so" for kind in GAZEBO_PLUGINS]
    return [f"gz-sim-{kind}" if kind.endswith("-system") else kind for kind in drives] + list(_ROS2_CONTROL)


def gazebo_drives(description: RobotDescription) -> tuple[GazeboDrive, ...]:
    """Convert a robot's Gazebo plugins to controllers; plugins of other kinds are left out.

    Raises:
        InputError: If a value in a plugin is invalid; with file and line.
    """
    drives: list[GazeboDrive] = []
    names: set[str] = set()
    for plugin in filter(is_drive, description.plugins):
        name = base = plugin_node_name(plugin)
        number = 1
        while name in names:
            number += 1
            name = f"{base}_{number}"
        names.add(name)
        try:
            reader = DrivePlugin(plugin, description, name)
            drive = GAZEBO_PLUGINS[plugin_kind(plugin)](reader)
            drives.append(replace(drive, unread=reader.unread))
        except CannotWorkError as error:
            drives.append(GazeboDrive(plugin, not_started=f"{name} ({plugin.filename}): {error}"))
        except TwinError:
            raise
        except Exception as error:
            if not GAZEBO_PLUGINS.is_of_others(plugin_kind(plugin)):
                raise
            what = f"{name} ({plugin.filename}): {described(error)}"
            drives.append(GazeboDrive(plugin, not_started=what, has_failed=True))
    return (*drives, *_rollers(description))


def _rollers(description: RobotDescription) -> Iterator[GazeboDrive]:
    """Yield what moves a base on wheels with friction in one direction: not a plugin, but it takes the place of one."""
    wheels = roller_wheels(description)
    if wheels:
        parameters = {
            "wheels": [wheel.joint for wheel in wheels],
            "center_x": [wheel.center[0] for wheel in wheels],
            "center_y": [wheel.center[1] for wheel in wheels],
            "direction_x": [wheel.direction[0] for wheel in wheels],
            "direction_y": [wheel.direction[1] for wheel in wheels],
            "rim": [wheel.rim for wheel in wheels],
            "friction": min(wheel.friction for wheel in wheels),
        }
        yield GazeboDrive(
            GazeboPlugin("", "roller_wheels", place=wheels[0].place),
            ControllerParameters("roller_wheels", ROLLER_WHEELS, parameters),
            interfaces=PLANAR_INTERFACES,
        )
