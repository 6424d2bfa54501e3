"""Which of a robot's topics its twin can follow or compare, and what each of them measures."""

from collections.abc import Mapping, Sequence

from drake_twin.calibration.measured import JOINT_STATES, NUMBERS
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, Endpoint

JOINTS, POSE, INERTIAL = "joints", "pose", "inertial"
_POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TransformStamped",
)
_IMU = "sensor_msgs/msg/Imu"
KINDS = {JOINT_STATES: JOINTS, _IMU: INERTIAL} | dict.fromkeys(_POSES, POSE)


@dataclass(frozen=True)
class Watched:
    """A topic that measures a robot.

    Attributes:
        topic: The robot's topic.
        type: Its ROS type.
        robot: The robot's name in the twin.
        kind: ``joints``, ``pose`` of the root link, or ``inertial``.
        twin_topic: The twin's topic that it is compared with.
    """

    topic: str
    type: str
    robot: str
    kind: str
    twin_topic: str


@dataclass(frozen=True)
class WatchedTopics:
    """What of a robot's topics is used.

    Attributes:
        commands: Topic of the robot → the twin's topic that hears the same.
        measured: Topic of the robot → what it measures.
        notes: What is not used, and why.
    """

    commands: Mapping[str, str]
    measured: Mapping[str, Watched]
    notes: tuple[str, ...]

    @property
    def topics(self) -> set[str]:
        """All topics that are used."""
        return {*self.commands, *self.measured}


def watched_topics(
    known: Mapping[str, str],
    endpoints: Sequence[Endpoint],
    renamed: Mapping[str, str],
    source: str,
    *,
    are_there: bool = True,
) -> WatchedTopics:
    """Find out which topics of a robot its twin has, too.

    Topics belong together by their names, or as ``renamed`` says. A topic of joint states, or of odometry, also belongs
    to the only robot that has such a topic of its own; of several topics with the pose of one robot the first is used.

    Args:
        known: The robot's topics with their types.
        endpoints: The twin's.
        renamed: Topic of the robot → topic of the twin.
        source: Where the robot's topics come from, for errors.
        are_there: Whether the robot has all these topics. If it may have some of them only, all are listened to, and
            nothing is noted.

    Raises:
        InputError: If ``renamed`` names a topic that there is not, or nothing of what is measured belongs to the twin.
    """
    own = {item.name: item for item in endpoints if item.kind in (PUBLISHED, COMMANDED)}
    for theirs, name in renamed.items():
        if theirs not in known:
            raise InputError(f"--map {theirs}={name}: {source} lacks the first topic", value=theirs, valid=known)
        if name not in own:
            raise InputError(f"--map {theirs}={name}: the twin lacks the second topic", value=name, valid=own)
    commands: dict[str, str] = {}
    measured: dict[str, Watched] = {}
    notes: list[str] = []
    for topic, kind in sorted(known.items(), key=lambda item: (item[0] not in renamed, item[0] not in own, item[0])):
        ours = own.get(renamed.get(topic, topic))
        if ours is not None and ours.kind == COMMANDED and ours.type == kind:
            commands[topic] = ours.name
            continue
        what = KINDS.get(kind)
        if what is None:
            if ours is None or ours.kind == COMMANDED:
                notes.append(f"{topic} ({kind}) is not used")
            continue
        if ours is None or KINDS.get(ours.type) != what:
            alike = [item for item in own.values() if KINDS.get(item.type) == what and item.robot]
            ours = alike[0] if len({item.robot for item in alike}) == 1 else None
        if ours is None:
            notes.append(f"{topic} ({kind}) belongs to no robot of the twin (--map {topic}=TWIN_TOPIC)")
        elif are_there and any((item.robot, item.kind) == (ours.robot, what) for item in measured.values()):
            notes.append(f"{topic} is not used: {ours.robot} has another topic for this")
        else:
            measured[topic] = Watched(topic, kind, ours.robot, what, ours.name)
    if not measured:
        valid = [item.name for item in endpoints if item.kind == PUBLISHED and item.type in NUMBERS]
        listed = ", ".join(known) or "none"
        text = f"no topic of {source} measures a robot of the twin; its topics are: {listed} (--map TOPIC=TWIN_TOPIC)"
        raise InputError(text, valid=valid)
    return WatchedTopics(commands, measured, tuple(notes) if are_there else ())
