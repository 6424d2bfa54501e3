"""The poses of a model and of its links, as gz-sim's PosePublisher publishes them."""

from typing import Any, ClassVar

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import transform_message
from drake_twin.controllers.truth_broadcaster import TruthBroadcaster
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.gazebo_drive import POSE_PUBLISHER
from drake_twin.description.robot_description import RobotDescription
from drake_twin.sensors.pose_sensor import MeasuredPose, PoseSensor
from drake_twin.sensors.sensor_setup import transform


@dataclass(frozen=True, kw_only=True)
class PosePublisherParameters:
    """Parameters of ``gz_sim/PosePublisher``, named after the elements of ``gz-sim-pose-publisher-system``.

    Attributes:
        publish_link_pose: Whether the links' poses in the model's frame are published.
        publish_model_pose: Whether the model's pose in the world is.
    """

    publish_link_pose: bool = True
    publish_model_pose: bool = False


@controller(POSE_PUBLISHER)
class PosePublisher(TruthBroadcaster):
    """Publish the true poses of a model in the world and of its links in the model's frame.

    Behaves as gz-sim's PosePublisher (from its sources) behind ros_gz_bridge, whose frames are ``model/link``; the
    world's frame is ``world`` here. These frames are not robot_state_publisher's: they are on this topic alone.

    .. pydrake_system::

        name: PosePublisher
        input_ports:
        - poses
        output_ports:
        - pose

    - ``poses``: as from `PoseSensor`: the model's pose and each link's, as far as they are published.
    - ``pose``: ``tf2_msgs/msg/TFMessage`` of the present time; None while inactive.
    """

    Parameters: ClassVar[type] = PosePublisherParameters

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why there is nothing to publish; None if there is something."""
        return None if parameters.publish_link_pose or parameters.publish_model_pose else "it publishes no pose"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, "poses")
        links = [(setup.robot, f"{setup.robot}/{link}") for link in self._links()]
        self._frames = [("world", setup.robot), *links] if setup.parameters.publish_model_pose else links
        self.declare_message_output("pose", "tf2_msgs/msg/TFMessage", self._pose, self._present())

    def num_values(self) -> int:
        """Return the size of the port ``poses``."""
        return 7 * (len(self._links()) + bool(self.setup.parameters.publish_model_pose))

    def own_sensor(self, plant: MultibodyPlant, instance: ModelInstanceIndex) -> PoseSensor:
        """Return a sensor of the poses; the model's frame is fixed to the root link, and need not be that link's."""
        description = self.setup.description

        def body(link: str) -> BodyIndex:
            return plant.GetBodyByName(drake_link_name(link), instance).index()

        root, X_RM = body(description.root_link), transform(description.root_pose).inverse()
        poses = [MeasuredPose(body(link), root, X_RF=X_RM) for link in self._links()]
        if self.setup.parameters.publish_model_pose:
            poses.insert(0, MeasuredPose(root, plant.world_body().index(), X_BP=X_RM))
        return PoseSensor(poses)

    def _links(self) -> tuple[str, ...]:
        """Return the links whose poses are published."""
        return self.setup.description.links if self.setup.parameters.publish_link_pose else ()

    def _pose(self, context: Context) -> Any:
        values = self._sensor.Eval(context).reshape(-1, 7).tolist()
        time = context.get_time()
        return messages.TFMessage(
            [
                transform_message(time, parent, child, pose)
                for (parent, child), pose in zip(self._frames, values, strict=True)
            ]
        )
