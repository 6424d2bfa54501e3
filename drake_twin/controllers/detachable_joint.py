"""A model that is fixed to a link until a message detaches it, as by gz-sim's DetachableJoint."""

from dataclasses import replace
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import DETACHABLE_JOINT
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.no_message import set_value

_ROUNDING = 1e-9  # s


@dataclass(frozen=True, kw_only=True)
class DetachableJointParameters:
    """Parameters of ``gz_sim/DetachableJoint``, named after the elements of ``gz-sim-detachable-joint-system``.

    Attributes:
        parent_link: The robot's link that the other model is fixed to.
        child_model: The other robot or model of the world; ``__model__`` for the robot itself.
        child_link: Its link.
        suppress_child_warning: Whether to say nothing where the other model does not exist.
    """

    parent_link: str
    child_model: str
    child_link: str
    suppress_child_warning: bool = False


@saved("JointRequest")
@dataclass(frozen=True)
class JointRequest(Frozen):
    """A message on ``attach`` or ``detach``.

    Attributes:
        id: The number of the request, counted from 1.
        attach: Whether it asks for the joint.
    """

    id: int
    attach: bool


@saved("Attachment")
@dataclass(frozen=True)
class Attachment(Frozen):
    """What a detachable joint does.

    Attributes:
        wanted: Whether the joint is asked for; where the other model does not exist, it comes with it.
        pose: The child link's pose in the parent link's frame, which is kept: a 3×4 matrix, row by row; empty while
            detached.
        since: When it was attached or detached (s).
        request: The number of the last request.
    """

    wanted: bool = True
    pose: tuple[float, ...] = ()
    since: float = 0.0
    request: int = 0


@controller(DETACHABLE_JOINT)
class DetachableJoint(StatefulController):
    """Ask for a fixed joint between a link of the robot and one of another model, and tell whether it is there.

    Behaves as gz-sim's DetachableJoint (from its sources): attached at the start, at the pose that the two have then.
    A model that comes later is attached when it comes. The joint itself is in the plant, see
    `drake_twin.diagram.detachable_joints`; the twin reads `asked`, and writes into the memory what has become of it.

    .. pydrake_system::

        name: DetachableJoint
        input_ports:
        - detach
        - attach
        output_ports:
        - state

    - ``detach``, ``attach``: ``std_msgs/msg/Empty``, as `JointRequest`.
    - ``state``: ``std_msgs/msg/String``, ``attached`` or ``detached``, once for each change: None but for one update
      period after it.
    """

    Parameters: ClassVar[type] = DetachableJointParameters

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why nothing can be attached to the robot; None if it can."""
        if parameters.parent_link in description.links:
            return None
        return f"the robot has no link {parameters.parent_link!r}"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, initial=Sample(memory=Attachment()))
        self._ports = [self.declare_topic_input(topic, "std_msgs/msg/Empty") for topic in ("detach", "attach")]
        self.declare_topic_output(
            "state", "std_msgs/msg/String", self._calc_state, {self.time_ticket(), self.sample_ticket()}
        )

    def read(self, topic: str, message: Any, context: Context) -> JointRequest:
        """Return a message as a request."""
        return JointRequest(self._newest(context).request + 1, topic == "attach")

    def activate(self, context: Context) -> None:
        """Obey from now on; the joint is as it was."""
        self.set_sample(context, replace(self.sample(context), active=True, time=context.get_time()))

    def asked(self, context: Context) -> Attachment:
        """Return the memory with the newest request."""
        return self._newest(context) if self.sample(context).active else self._memory(context)

    def _memory(self, context: Context) -> Attachment:
        memory: Attachment = self.sample(context).memory
        return memory

    def _newest(self, context: Context) -> Attachment:
        memory = self._memory(context)
        detach, attach = self._ports
        for port in (detach, attach) if memory.wanted else (attach, detach):  # of two at once, what changes something
            request = self.received(port, context)
            if request is not None and request.id > memory.request:
                memory = replace(memory, wanted=request.attach, request=request.id)
        return memory

    def _calc_state(self, context: Context, output: AbstractValue) -> None:
        memory = self._memory(context)
        is_new = _ROUNDING < context.get_time() - memory.since <= self.setup.update_period + _ROUNDING
        is_told = is_new and self.sample(context).active and (memory.pose or memory.request)
        set_value(output, messages.String("attached" if memory.pose else "detached") if is_told else None)
