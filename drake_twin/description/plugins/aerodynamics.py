"""The systems of gz-sim that let the air act on links as on wings, as controllers that command nothing."""

from math import pi
from typing import Any

import numpy as np

from drake_twin.description.gazebo_drive import LIFT_DRAG, CannotWorkError, DrivePlugin, GazeboDrive, gazebo_plugin

# Element → gz-sim's default.
_LIFT_DRAG = {
    "a0": 0.0,
    "cla": 1.0,
    "cda": 0.01,
    "cma": 0.0,
    "alpha_stall": pi / 2,
    "cla_stall": 0.0,
    "cda_stall": 1.0,
    "cma_stall": 0.0,
    "cm_delta": 0.0,
    "area": 1.0,
    "air_density": 1.2041,
    "control_joint_rad_to_cl": 4.0,
}
_NOT_NEGATIVE = ("alpha_stall", "area", "air_density")


@gazebo_plugin("gz-sim-lift-drag-system")
def lift_drag_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-lift-drag-system`` to the twin's own controller of this kind."""
    parameters = _wing(plugin, _LIFT_DRAG)
    parameters["radial_symmetry"] = plugin.flag("radial_symmetry", False)
    parameters["reversible"] = plugin.flag("reversible", False)
    parameters["control_joint_name"] = joint = plugin.text("control_joint_name", "")
    if joint:
        plugin.check_joints([joint])
    if not parameters["radial_symmetry"] and not np.cross(parameters["forward"], parameters["upward"]).any():
        raise CannotWorkError("<upward> is along <forward>")
    return plugin.drive(LIFT_DRAG, parameters)


def _wing(plugin: DrivePlugin, numbers: dict[str, float]) -> dict[str, Any]:
    """Return the parameters that both kinds of wings have, and some that are numbers."""
    link = plugin.text("link_name", "")
    if link not in plugin.description.links:
        raise CannotWorkError(f"the robot has no link {link!r}" if link else "<link_name> is missing")
    values: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in numbers.items()}
    for tag in _NOT_NEGATIVE:
        if values[tag] < 0.0:
            raise plugin.error(f"<{tag}> is {values[tag]:g}, and has to be zero or more")
    values["cp"] = list(plugin.vector("cp"))
    for tag, default in (("forward", [1.0, 0.0, 0.0]), ("upward", [0.0, 0.0, 1.0])):
        values[tag] = list(plugin.vector(tag)) if plugin.text(tag, "") else default
    if not any(values["forward"]):
        raise CannotWorkError("<forward> is zero")
    return {"link_name": link, **values}
