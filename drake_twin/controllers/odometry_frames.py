"""The names of the two frames of a drive's odometry."""

from drake_twin.controllers.base_controller import ControllerSetup

TF_ODOMETRY = "tf_odometry"  # the port of the transform, which is published on /tf and not on a topic of its own


def odometry_frames(
    setup: ControllerSetup, odom_frame_id: str, base_frame_id: str, *, prefix_enable: bool = False, prefix: str = ""
) -> tuple[str, str]:
    """Return the odometry frame and the base's frame, as named on ``/tf``.

    As in ros2_controllers the prefix, or without one the namespace, goes before both names. If the twin prefixes the
    robot's frames to keep robots apart, it prefixes these two as well, unless they begin with that prefix already.
    Without a prefix the base's frame is the robot's link, also if the link's name has the namespace before it.

    Args:
        setup: The controller's setup: namespace, frame prefix and links.
        odom_frame_id: The odometry frame's name in the parameters.
        base_frame_id: The base link's name in the parameters.
        prefix_enable: ``tf_frame_prefix_enable``.
        prefix: ``tf_frame_prefix``; a ``~`` in it stands for the namespace.
    """
    namespace, own = setup.namespace.strip("/"), setup.frame_prefix
    odom, base = odom_frame_id.lstrip("/"), base_frame_id.lstrip("/")
    before = (prefix.replace("~", namespace) or namespace).strip("/") if prefix_enable else ""
    if before:
        return _within(own, f"{before}/{odom}"), _within(own, f"{before}/{base}")
    if namespace and base not in setup.description.links:
        links = (f"{namespace}/{base}", f"{namespace}_{base}")
        base = next((link for link in links if link in setup.description.links), base)
    return _within(own, odom), own + base


def _within(prefix: str, name: str) -> str:
    return name if name.startswith(prefix) else prefix + name
