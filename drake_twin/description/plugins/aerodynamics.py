"""The systems of gz-sim that let the air act on links as on wings, as controllers that command nothing."""

from math import pi
from typing import Any

import numpy as np

from drake_twin.description.gazebo_drive import (
    ADVANCED_LIFT_DRAG,
    LIFT_DRAG,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)

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
_ADVANCED = {
    **dict.fromkeys(("CL0", "CD0", "CLa", "CYa", "Cella", "Cena", "CLb", "CYb", "Cellb", "Cemb", "Cenb"), 0.0),
    **{f"{kind}{rate}": 0.0 for rate in "pqr" for kind in ("CD", "CY", "CL", "Cell", "Cem", "Cen")},
    "alpha_stall": pi / 2,
    "area": 1.0,
    "AR": 0.0,
    "mac": 0.0,
    "eff": 0.0,
    "air_density": 1.2041,
}
_NOT_NEGATIVE = ("alpha_stall", "area", "air_density", "AR", "mac", "eff")
_WRITTEN_OVER = ("Cem0", "Cema", "Cema_stall")
_NOT_READ = ("a0", "CLa_stall", "CDa_stall", "radial_symmetry", "control_joint_rad_to_cl", "control_surface/index")
_SURFACE = ("direction", "CL_ctrl", "CD_ctrl", "CY_ctrl", "Cell_ctrl", "Cem_ctrl", "Cen_ctrl")


@gazebo_plugin("gz-sim-lift-drag-system")
def lift_drag_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-lift-drag-system`` to the forces of the air on a wing, by its angle of attack."""
    parameters = _wing(plugin, _LIFT_DRAG)
    parameters["radial_symmetry"] = plugin.flag("radial_symmetry", False)
    parameters["reversible"] = plugin.flag("reversible", False)
    parameters["control_joint_name"] = joint = plugin.text("control_joint_name", "")
    if joint:
        plugin.check_joints([joint])
    if not parameters["radial_symmetry"] and not np.cross(parameters["forward"], parameters["upward"]).any():
        raise CannotWorkError("<upward> is along <forward>")
    return plugin.drive(LIFT_DRAG, parameters)


@gazebo_plugin("gz-sim-advanced-lift-drag-system")
def advanced_lift_drag_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-advanced-lift-drag-system`` to the air on an aircraft, by its derivatives."""
    parameters = _wing(plugin, _ADVANCED)
    for tag in ("area", "AR", "eff"):
        if parameters[tag] == 0.0:
            raise CannotWorkError(f"<{tag}> is {'zero' if plugin.has(tag) else 'missing'}")
    if not any(parameters["upward"]):
        raise CannotWorkError("<upward> is zero")
    for tag in _NOT_READ:  # by gz-sim, whatever its files have
        plugin.has(tag)
    discarded = [tag for tag in _WRITTEN_OVER if plugin.number(tag, 0.0)]
    warnings = [f"<{', <'.join(f'{tag}>' for tag in discarded)}: gz-sim reads and does not use it"] if discarded else ()
    return plugin.drive(ADVANCED_LIFT_DRAG, {**parameters, **_surfaces(plugin)}, warnings=tuple(warnings))


def _surfaces(plugin: DrivePlugin) -> dict[str, Any]:
    """Return the parameters of the first control surfaces, as many as the plugin counts."""
    joints = plugin.texts("control_surface/name")
    plugin.check_joints(joints)
    values: dict[str, Any] = {tag: plugin.numbers(f"control_surface/{tag}") for tag in _SURFACE}
    if any(len(numbers) != len(joints) for numbers in values.values()):
        raise CannotWorkError(f"each <control_surface> needs a name and {', '.join(_SURFACE)}")
    count = plugin.number("num_ctrl_surfaces", 0.0)
    if count != int(count) or not 0 <= count <= len(joints):
        raise CannotWorkError(f"<num_ctrl_surfaces> is {count:g}, and there are {len(joints)}")
    values["directions"] = values.pop("direction")
    return {tag: list(numbers[: int(count)]) for tag, numbers in {"joints": joints, **values}.items()}


def _wing(plugin: DrivePlugin, numbers: dict[str, float]) -> dict[str, Any]:
    """Return the parameters that both kinds of wings have, and some that are numbers."""
    link = plugin.link()
    values: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in numbers.items()}
    for tag in _NOT_NEGATIVE:
        if values.get(tag, 0.0) < 0.0:
            raise plugin.error(f"<{tag}> is {values[tag]:g}, and has to be zero or more")
    values["cp"] = list(plugin.vector("cp"))
    for tag, default in (("forward", [1.0, 0.0, 0.0]), ("upward", [0.0, 0.0, 1.0])):
        values[tag] = list(plugin.vector(tag)) if plugin.text(tag, "") else default
    if not any(values["forward"]):
        raise CannotWorkError("<forward> is zero")
    return {"link_name": link, **values}
