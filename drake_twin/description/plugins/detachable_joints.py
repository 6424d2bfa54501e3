"""The system of gz-sim that fixes another model to a link until a message detaches it, as a controller."""

from dataclasses import replace

from drake_twin.description.gazebo_drive import (
    DETACHABLE_JOINT,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)


@gazebo_plugin("gz-sim-detachable-joint-system")
def detachable_joint_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-detachable-joint-system`` to the twin's own controller of this kind."""
    parameters: dict[str, object] = {}
    for tag in ("parent_link", "child_model", "child_link"):
        parameters[tag] = plugin.text(tag, "")
        if not parameters[tag]:
            raise CannotWorkError(f"<{tag}> is missing")
    if parameters["parent_link"] not in plugin.description.links:
        raise CannotWorkError(f"the robot has no link {parameters['parent_link']!r}")
    parameters["suppress_child_warning"] = plugin.flag("suppress_child_warning", False)
    older = plugin.has("topic") and not plugin.has("detach_topic")
    names = {
        "detach": ("topic" if older else "detach_topic", "detachable_joint/detach"),
        "attach": ("attach_topic", "detachable_joint/attach"),
        "state": ("output_topic", "detachable_joint/state"),
    }
    drive = plugin.drive(DETACHABLE_JOINT, parameters, names)
    if plugin.has("output_topic"):
        return drive
    state = f"/model/{parameters['child_model']}/detachable_joint/state"
    return replace(drive, gz_topics={**drive.gz_topics, "state": state})
