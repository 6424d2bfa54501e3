"""A drive's controller with joints that do exactly what they are told, so that its numbers can be checked by hand."""

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import make_value, or_none

STEP = 0.001  # s, of the joints


class ObedientJoints(LeafSystem):
    """Joints that have the commanded velocity, or are at the commanded position, from one step to the next."""

    def __init__(self, claims):
        super().__init__()
        size = len(claims)
        self.is_velocity = np.array([claim.name == "velocity" for claim in claims])
        self.commands = self.DeclareVectorInputPort("commands", size)
        state = self.DeclareDiscreteState(2 * size)
        self.DeclareStateOutputPort("state", state)
        self.DeclarePeriodicDiscreteUpdateEvent(STEP, 0.0, self.move)

    def move(self, context, discrete_state):
        position, velocity = np.split(context.get_discrete_state_vector().value().copy(), 2)
        commands = self.commands.Eval(context)
        velocity = np.where(self.is_velocity & np.isfinite(commands), commands, 0.0)
        steered = ~self.is_velocity & np.isfinite(commands)
        position = np.where(steered, commands, position + velocity * STEP)
        discrete_state.set_value(np.concatenate([position, velocity]))


class Driven:
    """A controller of a type, made from parameters as in a YAML file, active from time 0 on."""

    def __init__(self, kind, parameters, *, period=0.01, links=("base_link",), wheels=None, upstream=None, **setup):
        cls = controller_class(kind)
        values, findings = read_parameters(cls.Parameters, ControllerParameters("drive", kind, parameters))
        self.warnings = tuple(finding.what for finding in findings)
        joints = [Joint(f"joint_of_{link}", "fixed", links[0], link) for link in links[1:]]
        description = RobotDescription("robot", tuple(links), tuple(joints))
        claims = cls.claimed_interfaces(values, description)
        names = [claim.joint.partition("/")[2] or claim.joint for claim in claims]
        layout = StateLayout(
            size=2 * len(names),
            positions={name: index for index, name in enumerate(names)},
            velocities={name: len(names) + index for index, name in enumerate(names)},
            efforts={},
        )
        self.controller = cls(
            ControllerSetup("drive", values, claims, description, layout, period, upstream=upstream or {}, **setup)
        )
        builder = DiagramBuilder()
        builder.AddSystem(self.controller)
        joints = builder.AddSystem(ObedientJoints(claims))
        builder.Connect(self.controller.get_command_interfaces_output_port(), joints.commands)
        builder.Connect(joints.GetOutputPort("state"), self.controller.get_state_input_port())
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        self.root = self.simulator.get_mutable_context()
        self.context = self.controller.GetMyMutableContextFromRoot(self.root)
        self.joints_context = joints.GetMyMutableContextFromRoot(self.root)
        for name, above in (upstream or {}).items():
            self.controller.GetInputPort(name).FixValue(self.context, np.full(above.size, np.nan))
        if wheels is not None:
            self.joints_context.SetDiscreteState(np.concatenate([wheels, np.zeros(len(wheels))]))
        self.controller.activate(self.context)

    def activate(self):
        for topic in self.controller.subscribed:
            self.put(topic, None)
        self.controller.activate(self.context)

    def put(self, topic, value):
        self.controller.GetInputPort(topic).FixValue(self.context, make_value(value))

    def send(self, x=0.0, y=0.0, z=0.0, stamp=0.0):
        (topic,) = self.controller.subscribed
        twist = messages.Twist(linear=messages.Vector3(x=x, y=y, z=0.0), angular=messages.Vector3(x=0.0, y=0.0, z=z))
        if self.controller.subscribed[topic].endswith("Stamped"):
            twist = messages.TwistStamped(header=messages.header(stamp), twist=twist)
        self.put(topic, self.controller.read(topic, twist, self.context))

    def advance(self, time):
        self.simulator.AdvanceTo(time)
        assert self.controller.fault(self.context) is None, self.controller.fault(self.context)

    @property
    def commands(self):
        return self.controller.get_command_interfaces_output_port().Eval(self.context).tolist()

    def message(self, port):
        return or_none(self.controller.GetOutputPort(port).Eval(self.context))

    @property
    def odometry(self):
        """x, y, heading, and the velocities x, y, about z."""
        (topic,) = (name for name, kind in self.controller.published.items() if kind == "nav_msgs/msg/Odometry")
        message = self.message(topic)
        pose, twist = message.pose.pose, message.twist.twist
        heading = 2.0 * np.arctan2(pose.orientation.z, pose.orientation.w)
        return np.array([pose.position.x, pose.position.y, heading, twist.linear.x, twist.linear.y, twist.angular.z])

    def commands_while(self, until, period=0.01, **command):
        """What is written after each update while a command is sent again and again."""
        written = []
        time = self.root.get_time()
        while time < until - 1e-9:
            self.send(**command)
            time = round(time + period, 9)
            self.advance(time - 1e-6)
            written.append(self.commands)
            self.advance(time)
        return np.array(written)
