"""The joints whose hardware components are not active at the start."""

from collections.abc import Mapping

from drake_twin.description.robot_description import RobotDescription


def joints_in_state(description: RobotDescription, states: Mapping[str, str], state: str) -> dict[str, str]:
    """Return joint or GPIO → its ``<ros2_control>`` tag, of the tags that are in a state.

    Args:
        description: The robot.
        states: Tag → ``inactive`` or ``unconfigured``; others are active.
        state: The state.
    """
    found: dict[str, str] = {}
    for system in description.systems:
        if states.get(system.name) == state:
            found |= {joint.name: system.name for joint in system.joints}
            found |= {gpio.name: system.name for gpio in system.gpios}
    return found


def idle_joints(description: RobotDescription, states: Mapping[str, str], *, uses_inactive: bool) -> dict[str, str]:
    """Return joint → why its hardware cannot be commanded.

    Args:
        description: The robot.
        states: Tag → ``inactive`` or ``unconfigured``; others are active.
        uses_inactive: Whether controllers may claim interfaces of inactive hardware.
    """
    return {
        joint: f"hardware component {system!r} is {state}"
        for state in ("unconfigured", *(() if uses_inactive else ("inactive",)))
        for joint, system in joints_in_state(description, states, state).items()
    }
