"""The robots of a bag as a scenario: their descriptions without what only a simulation or hardware needs."""

from xml.etree import ElementTree

from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.robot_model import as_expanded
from drake_twin.errors import InputError
from drake_twin.playback.bag import Bag
from drake_twin.playback.recorded_frames import RecordedFrames, RecordedRobot, is_frames
from drake_twin.scenario import Robot, Scenario, World, name_in_twin

_APART = 10.0  # m between robots until their transforms come


def recorded_scenario(bag: Bag, package_paths: tuple[str, ...] = ()) -> tuple[Scenario, tuple[RecordedRobot, ...]]:
    """Return a scenario of the robots that a bag describes, without a ground, and what they are in the bag.

    Args:
        bag: The bag.
        package_paths: Folders of ROS packages to search first.

    Raises:
        InputError: If the bag has no description, or one cannot be used.
    """
    if not bag.descriptions:
        text = "the bag has no robot_description, which says what its robots look like: record that topic, too"
        raise InputError(text, valid=bag.topics, value="/robot_description")
    fixed = RecordedFrames()
    for message in bag.messages(lambda topic, kind: is_frames(topic, kind) and topic.endswith("tf_static")):
        fixed.add(message)
    robots: list[Robot] = []
    recorded: list[RecordedRobot] = []
    for index, (topic, text) in enumerate(bag.descriptions.items()):
        namespace = topic.rpartition("/")[0]
        root = _parsed(topic, text)
        named = root if root.tag == "robot" else root.find("model")
        own = "robot" if named is None else named.get("name", "robot")
        robot = RecordedRobot(
            name_in_twin(namespace.strip("/").replace("/", "_") or own), namespace, _root_link(root, topic)
        )
        if any(item.name == robot.name for item in robots):
            raise InputError(f"{topic}: there is a robot {robot.name!r} already")
        file = lasting_file(
            f"{robot.name}.{'sdf' if root.tag == 'sdf' else 'urdf'}",
            as_expanded(ElementTree.tostring(root, encoding="unicode")),
        )
        found = fixed.in_root(robot)
        if found is None:
            xyz, rpy = (0.0, _APART * index, 0.0), (0.0, 0.0, 0.0)
        else:
            x, y, z = found[1].translation.tolist()
            roll, pitch, yaw = found[1].rotation.as_euler("xyz").tolist()
            xyz, rpy = (x, y, z), (roll, pitch, yaw)
        robots.append(Robot(robot.name, str(file), namespace=namespace or "/", xyz=xyz, rpy=rpy, active_controllers=()))
        recorded.append(robot)
    scenario = Scenario(robots=tuple(robots), world=World(ground=False), package_paths=package_paths)
    return scenario, tuple(recorded)


def _parsed(topic: str, text: str) -> ElementTree.Element:
    """Return a description without controllers and sensors, which only a simulation or hardware needs.

    Raises:
        InputError: If it is not XML.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InputError(f"{topic} is not XML: {error}") from None
    for tag in ("ros2_control", "transmission"):
        for element in root.findall(tag):
            root.remove(element)
    for gazebo in root.findall("gazebo"):
        for element in (*gazebo.findall("plugin"), *gazebo.findall("sensor")):
            gazebo.remove(element)
    return root


def _root_link(root: ElementTree.Element, topic: str) -> str:
    """Return the name of the link that no joint moves.

    Raises:
        InputError: If every link is below a joint.
    """
    children = {child.get("link", child.text) for child in root.iter("child")}
    names = [link.get("name", "") for link in root.iter("link") if link.get("name") not in children]
    if not names:
        raise InputError(f"{topic}: the description has no link that is not below a joint")
    return names[0]
