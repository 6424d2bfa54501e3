"""The launch-like builder: a twin in plain Python, one call for each robot, frame and command."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from drake_twin.description.package_index import absolute_path
from drake_twin.errors import InputError
from drake_twin.findings import Finding
from drake_twin.requirements import imports_explained
from drake_twin.scenario import DISCRETE, Command, NodeProgram, Robot, Scenario, StaticTransform, World
from drake_twin.scenario.robot_options import RobotOptions, address, robot_of, takes_robot_options, text, vector3

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

    from drake_twin.diagram.twin_diagram import Extension
    from drake_twin.planning.robot_plan import RobotPlan
    from drake_twin.ros2.launch.launch_description import LaunchDescription
    from drake_twin.twin.twin import Twin

_log = logging.getLogger(__name__)


class TwinBuilder:
    """Collect robots, frames and commands like a launch file, and build a `Scenario` or a running `Twin`.

    Every call returns the builder, so calls can be chained::

        twin = (
            TwinBuilder(time_step=0.001)
            .robot("robot_1", "package://rover_description/urdf/rover.urdf.xacro", xyz=(0, 0, 0.13))
            .robot("robot_2", "package://rover_description/urdf/rover.urdf.xacro", xyz=(0, 2, 0.13))
            .static_transform("world", "robot_1_odom")
            .build()
        )

    Args:
        time_step: The physics step (s); by default that of a launched world, or 0.001.
        contact_approximation: Drake's discrete contact solver: lagged, similar or sap.
        engine: ``discrete``, or ``cenic`` for Drake's convex integrator with error control.
        accuracy: The accuracy of ``cenic``.
        world: The world: gravity, ground, and a world file.
        seed: What the noise of sensors is drawn from.
        sensor_noise: Whether sensors have the noise that their files give them.
        clock_rate: The rate of ``/clock`` (Hz); 0 for each physics step.
        islands: How many robots share a plant where they are far from others; 0 for one plant, None for the default.
        threads: How many threads step islands; 0 for one on each core.
    """

    def __init__(
        self,
        time_step: float | None = None,
        contact_approximation: str = "lagged",
        world: World | None = None,
        engine: str = DISCRETE,
        accuracy: float = 1e-3,
        seed: int = 0,
        sensor_noise: bool = True,
        clock_rate: float = 0.0,
        islands: int | None = None,
        threads: int = 0,
    ):
        self._islands, self._threads = islands, threads
        self._clock_rate = float(clock_rate)
        self._seed, self._sensor_noise = seed, sensor_noise
        self._engine, self._accuracy = engine, float(accuracy)
        self._time_step = None if time_step is None else float(time_step)
        self._launched_step = 0.001
        self._contact_approximation = contact_approximation
        self._world = world or World()
        if self._world.file is not None:
            self._world = replace(self._world, file=address(self._world.file))
        self._package_paths: list[str] = []
        self._robots: list[Robot] = []
        self._static_transforms: list[StaticTransform] = []
        self._commands: list[Command] = []
        self._nodes: list[NodeProgram] = []
        self._findings: list[Finding] = []
        self._plans: list[RobotPlan] = []
        self._extensions: list[Extension] = []

    def __copy__(self) -> TwinBuilder:
        """Return a builder that collects on its own from here."""
        copied = type(self)()
        copied.__dict__ |= {
            name: list(value) if isinstance(value, list) else value for name, value in self.__dict__.items()
        }
        return copied

    def package_path(self, folder: str | Path) -> TwinBuilder:
        """Search a folder first for ROS packages."""
        self._package_paths.append(absolute_path(folder))
        return self

    @takes_robot_options
    def robot(self, name: str, model: str | Path, **options: Unpack[RobotOptions]) -> TwinBuilder:
        """Add a robot.

        Args:
            name: Its name in the twin.
            model: Its file.
            **options: The other fields of `drake_twin.scenario.Robot`: lists for tuples, paths for addresses, and for
                one parameters file no list.

        Raises:
            InputError: If a value is of another kind.
        """
        self._robots.append(robot_of(name, model, options))
        return self

    def controller(
        self, robot: str, name: str, type: str, parameters: Mapping[str, Any] | None = None, *, active: bool = True
    ) -> TwinBuilder:
        """Add a controller to a robot, beside those of its parameters files.

        Args:
            robot: The name of a robot that has been added.
            name: The controller's name, the prefix of its topics.
            type: The controller's type as in a parameters file; ``my_pkg/MyController`` may be your own.
            parameters: Its parameters, as below ``ros__parameters`` in a parameters file.
            active: Whether it is active at the start instead of inactive.

        Raises:
            InputError: If the robot is unknown.
        """
        names = [item.name for item in self._robots]
        if robot not in names:
            raise InputError(f"unknown robot {robot!r}", value=robot, valid=names)
        index = names.index(robot)
        known = self._robots[index]
        added = {**known.added_controllers, name: {"type": type, **(parameters or {})}}
        if not active:
            known = replace(known, inactive_controllers=(*known.inactive_controllers, name))
        elif known.active_controllers is not None:
            known = replace(known, active_controllers=(*known.active_controllers, name))
        self._robots[index] = replace(known, added_controllers=added)
        return self

    def system(self, extension: Extension) -> TwinBuilder:
        """Add your own systems to the Drake diagram.

        Args:
            extension: Called with the ``DiagramBuilder`` and the `DiagramParts` before the diagram is built, and again
                whenever it is rebuilt, for example after a robot is spawned.
        """
        self._extensions.append(extension)
        return self

    def launch(self, what: LaunchDescription | str | Path, **arguments: object) -> TwinBuilder:
        """Add everything that a launch description or a launch file starts: robots, frames, commands and its world.

        Args:
            what: A description made of `drake_twin.launch`'s entities, or a Python, XML or YAML launch file.
            **arguments: Values for its arguments.

        Raises:
            InputError: If it cannot be used or starts no robot.
        """
        from drake_twin.builder.launch_file import launch_description_scenario, launch_file_scenario

        given = {name: text(value) for name, value in arguments.items()}
        if isinstance(what, str | Path):
            launched = launch_file_scenario(what, given, self._package_paths)
        else:
            launched = launch_description_scenario(what, given, self._package_paths)
        scenario = launched.scenario
        self._robots += scenario.robots
        self._plans += launched.plans
        self._static_transforms += scenario.static_transforms
        self._commands += scenario.commands
        self._nodes += scenario.nodes
        self._findings += scenario.findings
        for line in launched.log:
            _log.info("%s", line)
        if scenario.time_step != 0.001:
            self._launched_step = scenario.time_step
        self._package_paths += [folder for folder in scenario.package_paths if folder not in self._package_paths]
        if scenario.world != World():
            self._world = scenario.world
        return self

    def static_transform(
        self,
        parent: str,
        child: str,
        *,
        xyz: Iterable[float] = (0.0, 0.0, 0.0),
        rpy: Iterable[float] = (0.0, 0.0, 0.0),
    ) -> TwinBuilder:
        """Fix the frame ``child`` in the frame ``parent`` (m, rad), like static_transform_publisher."""
        what = f"of static transform {parent!r} to {child!r}"
        self._static_transforms.append(
            StaticTransform(parent, child, vector3(xyz, f"xyz {what}"), vector3(rpy, f"rpy {what}"))
        )
        return self

    def command(
        self,
        topic: str,
        data: Iterable[float] | Mapping[str, Any],
        *,
        time: float = 0.0,
        period: float | None = None,
    ) -> TwinBuilder:
        """Publish a command at a simulation time, and again at a period if that is given.

        Args:
            topic: The full topic name.
            data: The numbers of a ``Float64MultiArray``, or the fields of any message as for ``ros2 topic pub``.
            time: The simulation time (s).
            period: The period (s).

        Raises:
            InputError: If the data are neither.
        """
        if not isinstance(data, Mapping):
            try:
                data = tuple(float(value) for value in data)
            except (TypeError, ValueError):
                raise InputError(f"{data!r} for {topic} is neither numbers nor the fields of a message") from None
        self._commands.append(Command(topic, data, float(time), period))
        return self

    def node(
        self,
        executable: str | Path,
        *arguments: str,
        package: str = "",
        name: str = "",
        namespace: str = "",
        remappings: Mapping[str, str] | None = None,
        parameters: Mapping[str, Any] | None = None,
        parameter_files: Iterable[str | Path] = (),
        environment: Mapping[str, str] | None = None,
        time: float = 0.0,
    ) -> TwinBuilder:
        """Run a rclpy program beside the robots, in lock-step with the simulation.

        Args:
            executable: A Python script; with a package, the name of its program as for ``ros2 run``.
            *arguments: Its command line.
            package: The ROS package.
            name: The node's name in place of its own.
            namespace: The node's namespace.
            remappings: Topic or service → the name in its place.
            parameters: Parameter → value.
            parameter_files: Parameters files, which single parameters override.
            environment: Variables that differ from those of the process.
            time: The simulation time at which it starts (s).
        """
        from drake_twin.ros2.ros_arguments import ros_arguments

        ros = ros_arguments(
            name,
            namespace,
            tuple((remappings or {}).items()),
            (*(Path(absolute_path(file)) for file in parameter_files), *([parameters] if parameters else ())),
        )
        self._nodes.append(
            NodeProgram(
                executable=str(executable) if package else absolute_path(executable),
                package=package,
                arguments=(*map(str, arguments), *ros),
                environment=dict(environment or {}),
                time=float(time),
            )
        )
        return self

    def scenario(self) -> Scenario:
        """Return the collected scenario as plain data.

        Raises:
            InputError: If it is invalid: two robots of one name, a time step that is not positive, a frame with two
                parents, …
        """
        return Scenario(
            robots=tuple(self._robots),
            time_step=self._launched_step if self._time_step is None else self._time_step,
            engine=self._engine,
            accuracy=self._accuracy,
            contact_approximation=self._contact_approximation,
            world=self._world,
            package_paths=tuple(self._package_paths),
            static_transforms=tuple(self._static_transforms),
            commands=tuple(self._commands),
            findings=tuple(self._findings),
            seed=self._seed,
            sensor_noise=self._sensor_noise,
            nodes=tuple(self._nodes),
            clock_rate=self._clock_rate,
            islands=self._islands,
            threads=self._threads,
        )

    def build(self, meshcat: Meshcat | None = None) -> Twin:
        """Build the running twin, with its nodes.

        Args:
            meshcat: A Meshcat page to draw on.

        Raises:
            InputError: As `scenario`, or if a file cannot be used.
        """
        with imports_explained():
            from drake_twin.services.node_programs import start_nodes
            from drake_twin.twin.twin import Twin

        twin = Twin(self.scenario(), meshcat, self._plans, self._extensions)
        start_nodes(twin)
        return twin
