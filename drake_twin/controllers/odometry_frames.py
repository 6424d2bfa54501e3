"""The names of the two frames of a drive's odometry."""

from drake_twin.controllers.base_controller import ControllerSetup


def odometry_frames(
    setup: ControllerSetup, odom_frame_id: str, base_frame_id: str, *, prefix_enable: bool = False, prefix: str = ""
) -> tuple[str, str]:
    """Return the odometry frame and the base's frame, as named on ``/tf``.

    ros2_controllers prepends the prefix, or without one the namespace, to both names. It does not know how
    robot_state_publisher names the links, so in a namespace the two often differ and the tree is broken. Here the
    base's frame is the one of the robot's link in the twin's ``/tf``, whatever the prefix, if the link exists. The
    odometry frame is upstream's; if the twin prefixes the robot's frames to keep robots apart, it prefixes the odometry
    frame as well.

    Args:
        setup: The controller's setup: namespace, frame prefix and links.
        odom_frame_id: The odometry frame's name in the parameters.
        base_frame_id: The base link's name in the parameters.
        prefix_enable: ``tf_frame_prefix_enable``.
        prefix: ``tf_frame_prefix``; a ``~`` in it stands for the namespace.
    """
    namespace = setup.namespace.strip("/")
    before = ""
    if prefix_enable:
        before = prefix.replace("~", namespace).strip("/") if prefix else namespace
        before = f"{before}/" if before else ""
    base = f"{setup.frame_prefix}{_link(setup, before, namespace, base_frame_id)}"
    odom = before + odom_frame_id.lstrip("/")
    return (odom if odom.startswith(setup.frame_prefix) else setup.frame_prefix + odom), base


def _link(setup: ControllerSetup, before: str, namespace: str, name: str) -> str:
    name = name.lstrip("/")
    candidates = [name, before + name]
    if namespace:
        candidates += [f"{namespace}/{name}", f"{namespace}_{name}"]
    links = set(setup.description.links)
    return next((candidate for candidate in candidates if candidate in links), name)
