"""A real arm that MuJoCo moves: other equations, other servos, other friction than the mirror's twin."""

import copy
import xml.etree.ElementTree as ET
from collections.abc import Sequence

import mujoco
import numpy as np
from real_robot import Base, RealRobot
from robot_commands import arm_start
from robot_faults import Fault

from drake_twin.builder.demo import demo_scenario
from drake_twin.description.package_index import PackageIndex
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Scenario

_TIME_STEP = 0.001  # s
_STUCK = 1e3  # dry friction of a joint that is stuck (N·m)
_HIT = np.array([0.06, 0.0, 0.0])  # where the claw is hit, in its frame (m)
_COMMANDED = ("joint_1", "joint_2", "joint_3", "joint_4")

# Servos of finite stiffness draw to the integral of the commanded velocity, as those of hobby and industrial arms do:
# they sag by a few mrad, and lag by 20 to 40 ms.
_STIFFNESS = (400.0, 500.0, 300.0, 8.0)  # N·m/rad
_SERVO_DAMPING = (8.0, 12.0, 6.0, 0.1)  # N·m·s/rad
_LIMITS = (20.0, 20.0, 15.0, 5.0)  # N·m
_ARMATURE = (0.02, 0.02, 0.01, 0.0005)  # inertia of motor and gears (kg·m²)
_DAMPING = (0.3, 0.25, 0.15, 0.08)  # N·m·s/rad, in place of 0.1
_FRICTION = (0.2, 0.2, 0.12, 0.02)  # N·m
_MASSES = {"turret": 0.9, "upper_arm": 0.75, "forearm": 0.42, "claw": 0.2}  # kg, in place of 0.8, 0.7, 0.4, 0.12
_EFFORTS = np.array([0.4, 1.7, 1.2, 0.1, 0.0])  # typical ones (N·m)


def arm_model(scenario: Scenario) -> mujoco.MjModel:
    """Return the model that follows from the arm's own URDF, without shapes: it touches nothing."""
    root = ET.fromstring(plan_robot(scenario.robots[0], PackageIndex()).description.text)
    for link in root.findall("link"):
        for tag in ("visual", "collision"):
            for shape in link.findall(tag):
                link.remove(shape)
    for joint in root.findall("joint"):
        for mimic in joint.findall("mimic"):
            joint.remove(mimic)
        if joint.get("name") in _COMMANDED:
            index = _COMMANDED.index(joint.get("name"))
            dynamics = joint.find("dynamics")
            dynamics.attrib.update(damping=str(_DAMPING[index]), friction=str(_FRICTION[index]))
    for tag in ("ros2_control", "gazebo", "material"):
        for other in root.findall(tag):
            root.remove(other)
    compiler = ET.SubElement(ET.SubElement(root, "mujoco"), "compiler")
    compiler.set("fusestatic", "false")
    spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
    spec.option.timestep = _TIME_STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for name, mass in _MASSES.items():
        spec.body(name).mass = mass
    for index, name in enumerate(_COMMANDED):
        joint = spec.joint(name)
        joint.armature = _ARMATURE[index]
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.set_to_intvelocity(_STIFFNESS[index], kv=_SERVO_DAMPING[index])
        servo.forcerange, servo.forcelimited = (-_LIMITS[index], _LIMITS[index]), True
        servo.actrange, servo.actlimited = joint.range, True
    follows = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, name1="joint_5", name2="joint_4")
    follows.objtype = mujoco.mjtObj.mjOBJ_JOINT
    follows.data[:2] = 0.0, -1.0
    model = spec.compile()
    model.dof_solimp[:, :2], model.dof_solref[:] = 0.995, (0.01, 1.0)  # else the friction of light fingers is viscous
    return model


class MujocoArm:
    """The package's arm in MuJoCo."""

    kind = "arm"
    joints = (*_COMMANDED, "joint_5")
    commanded = _COMMANDED
    effort_sizes = _EFFORTS

    def __init__(self, scenario: Scenario):
        self._built = arm_model(scenario)
        self._places = [self._built.joint(name).qposadr[0] for name in self.joints]
        self._rates = [self._built.joint(name).dofadr[0] for name in self.joints]
        self.start(None)

    @property
    def time(self) -> float:
        """True time (s)."""
        return self._steps * _TIME_STEP

    def start(self, generator: np.random.Generator | None) -> None:
        """Return to the start."""
        self.model = copy.copy(self._built)
        self.data = mujoco.MjData(self.model)
        self._steps = 0
        positions = arm_start(generator)
        self.data.qpos[self._places] = [*positions, -positions[-1]]
        self.data.act[:] = positions
        mujoco.mj_forward(self.model, self.data)

    def advance(self, time: float) -> None:
        """Move until a time (s)."""
        steps = int(np.ceil(time / _TIME_STEP - 1e-6))
        if steps > self._steps:
            mujoco.mj_step(self.model, self.data, steps - self._steps)
        self._steps = steps

    def command(self, velocities: Sequence[float]) -> None:
        """Drive the joints."""
        self.data.ctrl[:] = velocities

    def measured(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return positions, velocities and efforts of all joints."""
        efforts = np.append(self.data.actuator_force, np.nan)
        return self.data.qpos[self._places], self.data.qvel[self._rates], efforts

    def base(self) -> Base | None:
        """Return nothing: it stands in one place."""
        return None

    def begin(self, fault: Fault) -> None:
        """Let a fault begin."""
        model, data = self.model, self.data
        claw = model.body("claw").id
        if fault.kind == "friction_risen":
            model.dof_frictionloss[self._rates[fault.joint]] += fault.size
        elif fault.kind == "joint_stuck":
            joint = self._rates[fault.joint]
            model.dof_frictionloss[joint] = _STUCK
            model.dof_solimp[joint, :2], model.dof_solref[joint] = 0.9999, (0.004, 1.0)  # hard: it hardly creeps
        elif fault.kind == "payload_changed":
            model.body_mass[claw] += fault.size
        elif fault.kind == "collision":
            turned = data.xmat[claw].reshape(3, 3)
            force = fault.size * turned @ [0.0, np.cos(fault.direction), np.sin(fault.direction)]
            lever = data.xpos[claw] + turned @ _HIT - data.xipos[claw]
            data.xfrc_applied[claw] = [*force, *np.cross(lever, force)]

    def go_on(self, fault: Fault) -> None:
        """Do nothing: what it is pushed with is constant."""

    def end(self, fault: Fault) -> None:
        """End a push."""
        if fault.kind == "collision":
            self.data.xfrc_applied[:] = 0.0


def mujoco_arm() -> RealRobot:
    """Return the arm, moved by MuJoCo."""
    scenario = demo_scenario("arduinobot", 1, drive=False)
    return RealRobot(MujocoArm(scenario), scenario)
