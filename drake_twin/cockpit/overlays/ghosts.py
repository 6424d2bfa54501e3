"""Robots as they will be, or were at the start: what is drawn of each, translucent, at other places."""

from collections.abc import Mapping
from math import isfinite

import numpy as np
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_folders import BodyFolders
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.controllers.base_controller import Controller
from drake_twin.diagram.plant import RobotInPlant
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.twin.twin import Twin

_REACHED = 0.01  # rad or m: a goal that is closer for all joints has no ghost
_GOAL, _START = (0.16, 0.62, 0.36), (0.45, 0.52, 0.60)


@overlay("starts", "Start", "A grey ghost of each robot where it stood at the start", "O")
class Starts:
    """A copy of each robot at the state that the twin starts from."""

    def __init__(self, scene: Scene, twin: Twin):
        self._scene = scene
        context = twin.plant.CreateDefaultContext()
        for plan in twin.built.plans:
            for body, X_WB in _drawn_bodies(scene, twin, plan, context).items():
                path = f"{OVERLAYS}/starts/{body}"
                scene.set_ghost(path, body, _START)
                scene.set_transform(path, X_WB)

    def draw(self) -> None:
        """Nothing: the start does not change."""

    def remove(self) -> None:
        """Remove the ghosts."""
        self._scene.delete(f"{OVERLAYS}/starts")


@overlay("goals", "Goal", "A green ghost of each robot at the positions that its controllers bring its joints to", "G")
class Goals:
    """A copy of each robot with its joints where trajectories end and where positions are commanded.

    It stands where the robot does, and is hidden while the robot is at its goal.
    """

    def __init__(self, scene: Scene, twin: Twin):
        self._scene, self._twin = scene, twin
        self._folders = BodyFolders(scene, twin, f"{OVERLAYS}/goals")
        self._context = twin.plant.CreateDefaultContext()
        self._shown: dict[str, Mapping[str, float]] = {}  # robot → the goal of its ghost
        self._drawn: dict[str, bool] = {}  # robots that have a ghost → whether it is visible

    def draw(self) -> None:
        """Move the ghosts to new goals, and hide those that are reached."""
        self._folders.draw()
        for plan in self._twin.built.plans:
            parts = self._twin.built.robots[plan.name]
            goal = self._goal(plan, parts)
            positions = self._twin.entities.state_vector(plan.name)
            is_there = any(abs(positions[parts.layout.positions[joint]] - at) > _REACHED for joint, at in goal.items())
            if is_there and goal != self._shown.get(plan.name):
                self._put(plan, parts, goal)
            if is_there != self._drawn.get(plan.name, is_there):
                self._scene.set_property(self._folder(plan), "visible", is_there)
            if plan.name in self._shown:
                self._drawn[plan.name] = is_there

    def remove(self) -> None:
        """Remove the ghosts."""
        self._folders.remove()

    def _goal(self, plan: RobotPlan, parts: RobotInPlant) -> dict[str, float]:
        goal: dict[str, float] = {}
        controllers = self._twin.built.parts[plan.name].controllers
        for name in self._twin.control.manager(plan.name).active:
            controller = controllers.get(name)
            if controller is not None and controller.claims:
                goal |= _goal_of(controller, controller.GetMyContextFromRoot(self._twin.context))
        return {joint: at for joint, at in goal.items() if joint in parts.layout.positions}

    def _put(self, plan: RobotPlan, parts: RobotInPlant, goal: Mapping[str, float]) -> None:
        """Place the links where they are at a goal, relative to the root link."""
        twin, context = self._twin, self._context
        q = np.array(twin.entities.state_vector(plan.name)[: twin.plant.num_positions(parts.instance)])
        for joint, at in goal.items():
            q[parts.layout.positions[joint]] = at
        twin.plant.SetPositions(context, parts.instance, q)
        root = twin.plant.GetBodyByName(plan.model.root_body, parts.instance)
        X_RW = twin.plant.EvalBodyPoseInWorld(context, root).inverse()
        _, X_FR = self._folders.of(root.index())
        is_new = plan.name not in self._shown
        for body, X_WB in _drawn_bodies(self._scene, twin, plan, context).items():
            path = f"{self._folder(plan)}/{body}"
            if is_new:
                self._scene.set_ghost(path, body, _GOAL)
            self._scene.set_transform(path, X_FR @ X_RW @ X_WB)
        self._shown[plan.name] = goal

    def _folder(self, plan: RobotPlan) -> str:
        instance = self._twin.built.robots[plan.name].instance
        root = self._twin.plant.GetBodyByName(plan.model.root_body, instance)
        return f"{self._folders.of(root.index())[0]}/ghost"


def _goal_of(controller: Controller, context: Context) -> dict[str, float]:
    """Return where a controller brings joints (rad or m): the end of its trajectory, or the positions it commands."""
    if (own := getattr(controller, "goal_positions", None)) is not None:  # it follows a trajectory
        return dict(own(context))
    if all(claim.name != "position" for claim in controller.claims):
        return {}
    commands = controller.get_command_interfaces_output_port().Eval(context)
    pairs = zip(controller.interfaces, commands, strict=True)
    return {item.joint: float(at) for item, at in pairs if item.name == "position" and isfinite(at)}


def _drawn_bodies(scene: Scene, twin: Twin, plan: RobotPlan, context: Context) -> dict[str, RigidTransform]:
    """Return the path of each body of a robot that is drawn, with its pose in a context of the plant."""
    plant, drawn = twin.plant, scene.shared(twin).body_paths
    bodies = [index for index in plant.GetBodyIndices(twin.built.robots[plan.name].instance) if int(index) in drawn]
    return {drawn[int(index)]: plant.EvalBodyPoseInWorld(context, plant.get_body(index)) for index in bodies}
