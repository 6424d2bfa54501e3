"""The frames of all robots on ``/tf`` and ``/tf_static``."""

from collections.abc import Iterator, Mapping, Sequence

from pydrake.systems.framework import DiagramBuilder

from drake_twin.controllers.odometry_frames import TF_ODOMETRY
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import POSED_JOINT_TYPES, Pose
from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.diagram.robot_topics import times_of
from drake_twin.diagram.topics import TF, PublishedTopic, Topics
from drake_twin.diagram.update_periods import published_rate, whole_steps
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import ROBOT_DESCRIPTION, robot_topic
from drake_twin.scenario import Scenario
from drake_twin.systems.robot_state_publisher import FixedFrame, LinkFrame, RobotFrames, RobotStatePublisher

_TYPE = "tf2_msgs/msg/TFMessage"
_SELDOM = 1.0  # Hz, of what does not move


def add_frames(
    builder: DiagramBuilder,
    scenario: Scenario,
    parts: PlantOfTwin,
    plans: Sequence[RobotPlan],
    robots: Mapping[str, RobotDiagram],
    topics: Topics,
) -> RobotStatePublisher:
    """Add the system that publishes the robots' descriptions and all frames.

    A frame has one parent: a true base pose is published only if nothing else places that frame.

    Raises:
        InputError: If two robots have a frame of one name, or a frame would have two parents or be its own ancestor.
    """
    static_transforms = [
        FixedFrame(item.parent.removeprefix("/"), item.child.removeprefix("/"), Pose(item.xyz, item.rpy))
        for item in scenario.static_transforms
    ]
    placed = {frame.child for frame in static_transforms} | {"world"}
    link_frames: dict[str, str] = {}
    for plan in plans:
        for link in plan.description.links:
            frame = plan.frame_prefix + link
            if frame in link_frames and frame != "world":
                raise InputError(
                    f"robots {link_frames[frame]!r} and {plan.name!r} would both publish the frame {frame!r}:"
                    " give them different frame prefixes"
                )
            link_frames[frame] = plan.name
            if frame in placed and link != plan.description.root_link:
                raise InputError(f"frame {frame!r} of robot {plan.name!r} would have two parents", value=frame)
    own = [plan for plan in plans if plan.base_frame not in placed]
    fixed_bases = [FixedFrame("world", plan.base_frame, plan.spawn_pose) for plan in own if plan.model.is_fixed]
    _refuse_circles(plans, static_transforms)
    odometry = _odometry(robots)
    placed_by_odometry = {child for _, child in odometry.values()}
    bases = {
        plan.name: plan.base_frame
        for plan in own
        if not plan.model.is_fixed and plan.base_frame not in placed_by_odometry
    }
    links = [frame for plan in plans for frame in _posed_links(parts, plan)]
    publisher = RobotStatePublisher(
        [
            RobotFrames(
                plan.name,
                plan.description,
                parts.robots[plan.name].layout_in_plant,
                plan.frame_prefix,
                bases.get(plan.name, ""),
            )
            for plan in plans
        ],
        parts.plant.num_multibody_states(),
        static_transforms=[*static_transforms, *fixed_bases],
        odometry=[f"{robot}/{name}/{TF_ODOMETRY}" for robot, name in odometry],
        links=links,
    )
    builder.AddNamedSystem("tf", publisher)
    builder.Connect(parts.plant.get_state_output_port(), publisher.get_state_input_port())
    if links:
        builder.Connect(parts.plant.get_body_poses_output_port(), publisher.GetInputPort("body_poses"))
    for robot, name in odometry:
        port = robots[robot].diagram.GetOutputPort(f"{name}/{TF_ODOMETRY}")
        builder.Connect(port, publisher.GetInputPort(f"{robot}/{name}/{TF_ODOMETRY}"))
    for plan in plans:
        topic = robot_topic(plan, ROBOT_DESCRIPTION)
        port = publisher.GetOutputPort(f"{plan.name}/robot_description")
        topics.publish(PublishedTopic(topic, "std_msgs/msg/String", port, None, plan.name))
    return publisher


def publish_frames(
    frames: RobotStatePublisher,
    plans: Sequence[RobotPlan],
    robots: Mapping[str, RobotDiagram],
    topics: Topics,
    time_step: float,
) -> None:
    """Publish all frames: the joints' as robot_state_publisher does, and each drive's as its controller does."""
    rate = max((_rate(plan, robots[plan.name]) for plan in plans), default=_SELDOM)
    topics.publish(PublishedTopic(TF, _TYPE, frames.get_tf_output_port(), rate, drafter=frames.tf_drafter()))
    topics.publish(PublishedTopic("/tf_static", _TYPE, frames.get_tf_static_output_port(), None))
    for robot, name in _odometry(robots):
        port = robots[robot].diagram.GetOutputPort(f"{name}/{TF_ODOMETRY}")
        times = times_of(robots[robot].controllers[name], TF_ODOMETRY, time_step)
        topics.publish(PublishedTopic(TF, _TYPE, port, robot=robot, controller=name, **times))


def _rate(plan: RobotPlan, robot: RobotDiagram) -> float:
    """Return the rate at which robot_state_publisher publishes a robot's moving joints (Hz).

    It waits for the first joint states that come a number of whole milliseconds after the last ones published.
    """
    if not plan.description.movable_joints:
        return _SELDOM
    period, frequency = robot.broadcaster.setup.update_period, plan.robot.publish_frequency
    interval = int(1000.0 / frequency) / 1000.0 if frequency else 0.0
    return published_rate(whole_steps(1.0 / max(interval, period), period) * period)


def _odometry(robots: Mapping[str, RobotDiagram]) -> dict[tuple[str, str], tuple[str, str]]:
    """Return robot and controller → the frames between which it publishes a transform."""
    return {
        (robot, name): controller.odometry_frames
        for robot, parts in robots.items()
        for name, controller in parts.controllers.items()
        if controller.odometry_frames is not None
    }


def colliding_transforms(robots: Mapping[str, RobotDiagram]) -> Iterator[Finding]:
    """Yield a finding for each further controller that publishes the pose of a frame."""
    first: dict[str, str] = {}
    for (robot, name), (_, child) in _odometry(robots).items():
        if child in first:
            what = f"controllers {first[child]} and {name} both publish the pose of {child!r} on /tf"
            yield Finding(Kind.WARNING, what, robot=robot)
        first.setdefault(child, name)


def _posed_links(parts: PlantOfTwin, plan: RobotPlan) -> Iterator[LinkFrame]:
    """Yield the links at joints whose poses do not follow from joint positions."""
    for joint in plan.description.joints:
        if joint.type in POSED_JOINT_TYPES:
            parent, child = (
                int(parts.plant.GetBodyByName(drake_link_name(link), parts.robots[plan.name].instance).index())
                for link in (joint.parent, joint.child)
            )
            yield LinkFrame(plan.frame_prefix + joint.parent, plan.frame_prefix + joint.child, parent, child)


def _refuse_circles(plans: Sequence[RobotPlan], static_transforms: Sequence[FixedFrame]) -> None:
    """Refuse static transforms that place a robot's base in a frame below that base.

    Raises:
        InputError: If there is such a circle.
    """
    parents = {frame.child: frame.parent for frame in static_transforms}
    for plan in plans:
        parents.update({plan.frame_prefix + j.child: plan.frame_prefix + j.parent for j in plan.description.joints})
    for frame in [plan.base_frame for plan in plans]:
        seen = []
        while frame in parents and frame not in seen:
            seen.append(frame)
            frame = parents[frame]
        if frame in seen:
            raise InputError(f"the static transforms put frame {frame!r} in a circle: {' in '.join([*seen, frame])}")
