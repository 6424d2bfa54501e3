"""The topics that a bridge carries and that nothing has."""

from collections.abc import Iterable, Iterator, Sequence

from drake_twin.description.gazebo_drive import of_model
from drake_twin.description.robot_description import Sensor
from drake_twin.errors import did_you_mean
from drake_twin.findings import Cause, Finding, Kind
from drake_twin.from_launch.bridges import BridgeLine
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import gazebo_default, is_same_topic, valid_topic
from drake_twin.planning.world_sensors import ModelPlan

# Types that only Gazebo's sensors publish.
_OF_SENSORS = {
    *(
        f"sensor_msgs/msg/{name}"
        for name in (
            *("CameraInfo", "FluidPressure", "Image", "Imu", "LaserScan", "MagneticField", "NavSatFix", "PointCloud2"),
        )
    ),
    "ros_gz_interfaces/msg/Altimeter",
    "ros_gz_interfaces/msg/Contacts",
    "ros_gz_interfaces/msg/LogicalCameraImage",
    "gps_msgs/msg/GPSFix",
}
_CLOSE = 0.9


def unpublished(lines: Iterable[BridgeLine], plans: Sequence[RobotPlan | ModelPlan]) -> Iterator[Finding]:
    """Yield a warning of each line of a bridge that names the topic of a sensor that no robot or model has.

    The topics of a sensor that the twin does not simulate are known by its ``<topic>``, or by the beginning of its
    default topic.
    """
    for line in lines:
        if not line.is_to_ros or line.ros_type not in _OF_SENSORS:
            continue
        if not any(_is_of(sensor, plan, line.gz) for plan in plans for sensor in plan.description.sensors):
            common = ": the bridge carries it, but no sensor publishes it in Gazebo"
            what = f"{line.gz} to {line.ros}{common}"
            yield Finding.at(Kind.WARNING, what, line.place, common=common, cause=Cause.BRIDGE)


def misspelt(lines: Sequence[BridgeLine], plans: Sequence[RobotPlan]) -> Iterator[Finding]:
    """Yield a warning of each line of a bridge whose topic no drive has, but one that no bridge carries is close to."""
    drives = {
        f"/{of_model(topic, plan.name).lstrip('/')}"
        for plan in plans
        for controller in plan.controllers
        if controller.wiring is not None
        for topic in controller.wiring.gz_topics.values()
    }
    left = drives - {line.gz for line in lines}
    for line in (line for line in lines if line.gz not in drives):
        if hint := did_you_mean(line.gz, sorted(left), _CLOSE):
            what = f"the bridge carries {line.gz}, which nothing has in Gazebo{hint}"
            yield Finding.at(Kind.WARNING, what, line.place, cause=Cause.BRIDGE)


def _is_of(sensor: Sensor, plan: RobotPlan | ModelPlan, gz: str) -> bool:
    known = [topic.in_gazebo for item in plan.sensors if item.sensor is sensor for topic in item.topics]
    if known:
        return any(is_same_topic(name, gz) for name in known)
    if sensor.topic:
        topic = f"/{valid_topic(sensor.topic)}"
        beside = f"{topic.rpartition('/')[0]}/camera_info"
        return gz in (topic, beside) or gz.startswith(f"{topic}/") or gz.strip("/") in sensor.text
    return is_same_topic(gazebo_default(plan.name, sensor, gz.rpartition("/")[2]), gz)
