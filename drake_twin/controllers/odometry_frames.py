"""The names of the two frames that a drive's odometry connects."""

from drake_twin.controllers.base_controller import ControllerSetup


def odometry_frames(
    setup: ControllerSetup, odom_frame_id: str, base_frame_id: str, *, prefix_enable: bool = False, prefix: str = ""
) -> tuple[str, str]:
    """The odometry frame and the base's frame, as they are called on ``/tf``.

    ros2_controllers puts the prefix, or the namespace where there is none, before both names. It cannot know what
    robot_state_publisher calls the links, so in a namespace the two often differ and the tree falls apart. Here the
    base's frame is the one that the robot's link has in the twin's ``/tf``, whatever the prefix, as long as there is
    such a link. The odometry frame is upstream's; where the twin itself put a prefix before the robot's frames to keep
    robots apart, that is before the odometry frame as well.

    Args:
        setup: whose namespace, frame prefix and robot count.
        odom_frame_id: the odometry frame's name in the parameters.
        base_frame_id: the base link's name in the parameters.
        prefix_enable: ``tf_frame_prefix_enable``.
        prefix: ``tf_frame_prefix``; ``~`` in it stands for the namespace.
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
