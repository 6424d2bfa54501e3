"""Poses and twists of all models and links as messages, as Gazebo's state plugin publishes them."""

from collections.abc import Mapping
from typing import Any

from pydrake.common.value import AbstractValue, Value
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.systems.no_message import empty_value
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class EntityStatePublisher(WitnesslessSystem):
    """Publish the true state of every model and link, computed on demand.

    Behaves as ``libgazebo_ros_state.so`` of gazebo_ros_pkgs.

    .. pydrake_system::

        name: EntityStatePublisher
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - model_states
        - link_states

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``model_states``: ``gazebo_msgs/msg/ModelStates``: each model's root link in the world (m, m/s, rad/s); topic
      ``/model_states``.
    - ``link_states``: ``gazebo_msgs/msg/LinkStates``: each link in the world, named ``model::link``; topic
      ``/link_states``.

    Args:
        models: Model → the index of its root link's body.
        links: Full name of a link → the index of its body.
    """

    def __init__(self, models: Mapping[str, int], links: Mapping[str, int]):
        super().__init__()
        self._models, self._links = dict(models), dict(links)
        self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self._velocities = self.DeclareAbstractInputPort("body_spatial_velocities", Value[list[SpatialVelocity]]())
        tickets = {self.input_port_ticket(port.get_index()) for port in (self._poses, self._velocities)}
        self._model_states = self.DeclareAbstractOutputPort(
            "model_states", empty_value, weakly(self._calc_model_states), tickets
        )
        self._link_states = self.DeclareAbstractOutputPort(
            "link_states", empty_value, weakly(self._calc_link_states), tickets
        )

    def get_body_poses_input_port(self) -> InputPort:
        """Return the port ``body_poses``."""
        return self._poses

    def get_body_spatial_velocities_input_port(self) -> InputPort:
        """Return the port ``body_spatial_velocities``."""
        return self._velocities

    def get_model_states_output_port(self) -> OutputPort:
        """Return the port ``model_states``."""
        return self._model_states

    def get_link_states_output_port(self) -> OutputPort:
        """Return the port ``link_states``."""
        return self._link_states

    def _calc_model_states(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.ModelStates(**self._states(context, self._models)))

    def _calc_link_states(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.LinkStates(**self._states(context, self._links)))

    def _states(self, context: Context, bodies: Mapping[str, int]) -> dict[str, Any]:
        poses, velocities = self._poses.Eval(context), self._velocities.Eval(context)
        return {
            "name": list(bodies),
            "pose": [_pose(poses[index]) for index in bodies.values()],
            "twist": [_twist(velocities[index]) for index in bodies.values()],
        }


def _pose(X: RigidTransform) -> Any:
    w, x, y, z = X.rotation().ToQuaternion().wxyz().tolist()
    return messages.Pose(
        position=messages.Point(*X.translation().tolist()), orientation=messages.Quaternion(x=x, y=y, z=z, w=w)
    )


def _twist(V: SpatialVelocity) -> Any:
    return messages.Twist(
        linear=messages.Vector3(*V.translational().tolist()), angular=messages.Vector3(*V.rotational().tolist())
    )
