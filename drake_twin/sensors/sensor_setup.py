"""What a sensor is built from."""

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, ModelInstanceIndex, RigidBody

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import Pose, RobotDescription, Sensor
from drake_twin.description.surroundings import Surroundings
from drake_twin.errors import InputError
from drake_twin.sensors.cameras.lazy_renderer import LazyRenderer
from drake_twin.sensors.noise import NoiseSource
from drake_twin.sensors.sensor_host import SensorHost

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldModel


@dataclass(frozen=True)
class SensorSetup:
    """What a sensor is built from.

    Attributes:
        sensor: The sensor as the file describes it.
        settings: What its kind's `SensorSystem.read` has returned.
        plant: The finalized plant, whose defaults are the robot's start state.
        instance: The robot in the plant.
        scene_graph: The scene graph with all shapes.
        frame: The ``frame_id`` of its messages.
        noise: What its noise is drawn from.
        description: The robot.
        host: The system that has its ports; a new one by default.
        prefix: The beginning of its ports' names there.
        surroundings: Where on Earth the world is, and its magnetic field.
        frame_prefix: The prefix of its link names in tf messages.
        renderer: What draws the pictures of cameras.
        owner: The name of its robot, or of its model of the world.
        anchors: Frame → pose in the world, of a static model, which has no bodies in the plant.
        models: The models of the world's file.
        wind: The velocity of the air in the world (m/s); None for one that changes, which `host` has an input for.
    """

    sensor: Sensor
    settings: Any
    plant: MultibodyPlant
    instance: ModelInstanceIndex
    scene_graph: SceneGraph | None = None
    frame: str = ""
    noise: NoiseSource = field(default_factory=NoiseSource)
    description: RobotDescription | None = None
    frame_prefix: str = ""
    host: SensorHost | None = None
    prefix: str = ""
    surroundings: Surroundings = field(default_factory=Surroundings)
    renderer: LazyRenderer = field(default_factory=LazyRenderer)
    owner: str = ""
    anchors: Mapping[str, RigidTransform] = field(default_factory=dict)
    models: "tuple[WorldModel, ...]" = ()
    wind: tuple[float, float, float] | None = (0.0, 0.0, 0.0)

    @property
    def body(self) -> RigidBody:
        """The body of its link; the world body for one of a static model."""
        if self.sensor.link in self.anchors:
            return self.plant.world_body()
        return self.plant.GetBodyByName(drake_link_name(self.sensor.link), self.instance)

    @property
    def joint(self) -> Joint:
        """Its joint."""
        return self.plant.GetJointByName(self.sensor.joint, self.instance)

    @property
    def pose(self) -> RigidTransform:
        """The pose of the sensor S in its `body` B, or in its joint's frame on the child.

        Raises:
            InputError: If the file's pose is relative to an unknown frame.
        """
        sensor = self.sensor
        own = sensor.pose.transform()
        if not sensor.pose_frame or sensor.pose_frame in (sensor.link, sensor.joint):
            return self.anchors[sensor.link] @ own if self.anchors else own
        if sensor.pose_frame in self.anchors:
            return self.anchors[sensor.pose_frame] @ own
        if self.anchors or not self.plant.HasFrameNamed(sensor.pose_frame, self.instance):
            what = f"sensor {sensor.name!r}: its pose is relative to the unknown frame {sensor.pose_frame!r}"
            raise InputError(what, file=sensor.place.file or None, line=sensor.place.line)
        frame = self.plant.GetFrameByName(sensor.pose_frame, self.instance)
        start = self.plant.CreateDefaultContext()
        base = self.body.body_frame() if sensor.link else self.joint.frame_on_child()
        return self.plant.CalcRelativeTransform(start, base, frame) @ own

    @property
    def start(self) -> RigidTransform:
        """The pose of the sensor in the world at the start."""
        body = self.plant.EvalBodyPoseInWorld(self.plant.CreateDefaultContext(), self.body)
        return body @ self.pose


def transform(pose: Pose) -> RigidTransform:
    """Return a pose as Drake's transform."""
    return pose.transform()
