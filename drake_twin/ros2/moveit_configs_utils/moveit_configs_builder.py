"""``moveit_configs_utils.MoveItConfigsBuilder``: the parameters of MoveIt's nodes, from a package's files."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any, Self

from drake_twin.dataclass import dataclass
from drake_twin.ros2.ament_index_python.packages import get_package_share_directory
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.command import Command
from drake_twin.ros2.launch_param_builder.launch_param_builder import ParameterBuilder
from drake_twin.ros2.launch_param_builder.utils import ParameterBuilderFileNotFoundError, load_xacro, load_yaml
from drake_twin.ros2.launch_ros.parameter_descriptions import ParameterValue

_PIPELINES = "_planning.yaml"


@dataclass
class MoveItConfigs:
    """Mappings of parameters, by what they are for.

    Attributes:
        package_path: The share folder of the robot's MoveIt package.
        robot_description: The URDF, as a parameter.
        robot_description_semantic: The SRDF.
        robot_description_kinematics: Solvers of inverse kinematics.
        planning_pipelines: Planners.
        trajectory_execution: The controllers that MoveIt uses.
        planning_scene_monitor: What is published of the planning scene.
        sensors_3d: Sensors.
        move_group_capabilities: Capabilities of ``move_group``.
        joint_limits: Limits of joints.
        moveit_cpp: Parameters of MoveItCpp.
        pilz_cartesian_limits: Limits of the Pilz planner.
    """

    package_path: str | Path | None = None
    robot_description: dict[str, Any] = field(default_factory=dict)
    robot_description_semantic: dict[str, Any] = field(default_factory=dict)
    robot_description_kinematics: dict[str, Any] = field(default_factory=dict)
    planning_pipelines: dict[str, Any] = field(default_factory=dict)
    trajectory_execution: dict[str, Any] = field(default_factory=dict)
    planning_scene_monitor: dict[str, Any] = field(default_factory=dict)
    sensors_3d: dict[str, Any] = field(default_factory=dict)
    move_group_capabilities: dict[str, Any] = field(default_factory=lambda: {"capabilities": ""})
    joint_limits: dict[str, Any] = field(default_factory=dict)
    moveit_cpp: dict[str, Any] = field(default_factory=dict)
    pilz_cartesian_limits: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return all parameters as one mapping."""
        parameters: dict[str, Any] = {}
        for name, values in vars(self).items():
            if name != "package_path":
                for key, value in values.items():
                    known = parameters.get(key)
                    both = isinstance(known, dict) and isinstance(value, dict)
                    parameters[key] = {**known, **value} if both and known is not None else value
        return parameters


class MoveItConfigsBuilder(ParameterBuilder):
    """Builds `MoveItConfigs` from a MoveIt package's files.

    Args:
        robot_name: The robot's name; its package is ``ROBOT_moveit_config``.
        robot_description: The name of the URDF's parameter, which begins those of others.
        package_name: The package, where it has another name.
    """

    def __init__(self, robot_name: str, robot_description: str = "robot_description", package_name: str | None = None):
        super().__init__(package_name or f"{robot_name}_moveit_config")
        self._description = robot_description
        self._configs = MoveItConfigs(package_path=self._package_path)
        self._urdf = self._package_path / "config" / f"{robot_name}.urdf"
        self._srdf = Path("config", f"{robot_name}.srdf")
        self._xacro_arguments: dict[str, str] = {}
        self._read_setup_assistant()
        own = self._package_path / "config" / f"{robot_name}.urdf.xacro"
        if own.exists():
            self._urdf = own

    def _read_setup_assistant(self) -> None:
        file = self._package_path / ".setup_assistant"
        if not file.exists():
            return
        config = (load_yaml(file) or {}).get("moveit_setup_assistant_config", {})
        urdf, srdf = (config.get(name) or config.get(name.upper()) or {} for name in ("urdf", "srdf"))
        if urdf.get("package") and urdf.get("relative_path"):
            self._urdf = Path(get_package_share_directory(urdf["package"])) / urdf["relative_path"]
        words = str(urdf.get("xacro_args") or "").split()
        self._xacro_arguments = dict(word.split(":=", 1) for word in words if ":=" in word)
        if srdf.get("relative_path"):
            self._srdf = Path(srdf["relative_path"])

    def robot_description(self, file_path: str | None = None, mappings: Mapping[str, Any] | None = None) -> Self:
        """Add the URDF; mappings, xacro's arguments, may be substitutions."""
        file = self._urdf if file_path is None else self._package_path / file_path
        self._configs.robot_description = self._xacro("", file, {**self._xacro_arguments, **(mappings or {})})
        return self

    def robot_description_semantic(
        self, file_path: str | None = None, mappings: Mapping[str, Any] | None = None
    ) -> Self:
        """Add the SRDF."""
        file = self._package_path / (file_path or self._srdf)
        self._configs.robot_description_semantic = self._xacro("_semantic", file, mappings or {})
        return self

    def robot_description_kinematics(self, file_path: str | None = None) -> Self:
        """Add the solvers of inverse kinematics."""
        values = self._values(file_path, "kinematics.yaml")
        self._configs.robot_description_kinematics = {f"{self._description}_kinematics": values}
        return self

    def joint_limits(self, file_path: str | None = None) -> Self:
        """Add limits of joints."""
        values = self._values(file_path, "joint_limits.yaml")
        self._configs.joint_limits = {f"{self._description}_planning": values}
        return self

    def pilz_cartesian_limits(self, file_path: str | None = None) -> Self:
        """Add limits of the Pilz planner, where the file exists."""
        file = self._package_path / (file_path or "config/pilz_cartesian_limits.yaml")
        if file.exists():
            self._configs.pilz_cartesian_limits = {f"{self._description}_planning": load_yaml(file)}
        return self

    def moveit_cpp(self, file_path: str | None = None) -> Self:
        """Add the parameters of MoveItCpp."""
        self._configs.moveit_cpp = self._values(file_path, "moveit_cpp.yaml")
        return self

    def trajectory_execution(self, file_path: str | None = None, moveit_manage_controllers: bool = True) -> Self:
        """Add the controllers that MoveIt uses; by default those of the only ``*_controllers.yaml``.

        Raises:
            RuntimeError: If there are several, and none is ``moveit_controllers.yaml``.
        """
        config = self._package_path / "config"
        name = "moveit_controllers.yaml"
        if file_path is None and not (config / name).exists():
            found = [file.name for file in sorted(config.glob("*_controllers.yaml")) if "ros" not in file.name]
            if len(found) != 1:
                raise RuntimeError(f"config holds {len(found)} files *_controllers.yaml: name one as file_path")
            name = found[0]
        values = {"moveit_manage_controllers": moveit_manage_controllers, **self._values(file_path, name)}
        self._configs.trajectory_execution = values
        return self

    def planning_scene_monitor(
        self,
        publish_planning_scene: bool = True,
        publish_geometry_updates: bool = True,
        publish_state_updates: bool = True,
        publish_transforms_updates: bool = True,
        publish_robot_description: bool = False,
        publish_robot_description_semantic: bool = False,
    ) -> Self:
        """Add what is published of the planning scene."""
        self._configs.planning_scene_monitor = {
            "publish_planning_scene": publish_planning_scene,
            "publish_geometry_updates": publish_geometry_updates,
            "publish_state_updates": publish_state_updates,
            "publish_transforms_updates": publish_transforms_updates,
            "publish_robot_description": publish_robot_description,
            "publish_robot_description_semantic": publish_robot_description_semantic,
        }
        return self

    def sensors_3d(self, file_path: str | None = None) -> Self:
        """Add sensors, where the file exists."""
        file = self._package_path / (file_path or "config/sensors_3d.yaml")
        if file.exists():
            self._configs.sensors_3d = load_yaml(file) or {}
        return self

    def planning_pipelines(
        self,
        default_planning_pipeline: str | None = None,
        pipelines: Sequence[str] | None = None,
        load_all: bool = True,
    ) -> Self:
        """Add planners: those given, or all of the package.

        Raises:
            RuntimeError: If the default is not one of them.
        """
        config = self._package_path / "config"
        names = list(
            pipelines or (file.name.removesuffix(_PIPELINES) for file in sorted(config.glob(f"*{_PIPELINES}")))
        )
        default = default_planning_pipeline or ("ompl" if "ompl" in names or not names else names[0])
        if names and default not in names:
            raise RuntimeError(f"default_planning_pipeline {default!r} is not one of {', '.join(names)}")
        self._configs.planning_pipelines = {"planning_pipelines": names, "default_planning_pipeline": default}
        for name in names:
            file = config / f"{name}{_PIPELINES}"
            self._configs.planning_pipelines[name] = (load_yaml(file) if file.exists() else None) or {}
        return self

    def to_moveit_configs(self) -> MoveItConfigs:
        """Return the configurations; what was not asked for is read from the files that the package has."""
        steps = (
            ("robot_description", self.robot_description),
            ("robot_description_semantic", self.robot_description_semantic),
            ("robot_description_kinematics", self.robot_description_kinematics),
            ("planning_pipelines", self.planning_pipelines),
            ("trajectory_execution", self.trajectory_execution),
            ("planning_scene_monitor", self.planning_scene_monitor),
            ("sensors_3d", self.sensors_3d),
            ("joint_limits", self.joint_limits),
            ("pilz_cartesian_limits", self.pilz_cartesian_limits),
        )
        for name, step in steps:
            if not getattr(self._configs, name):
                try:
                    step()
                except (ParameterBuilderFileNotFoundError, RuntimeError):  # MoveIt's nodes need it, and none is started
                    continue
        return self._configs

    def to_dict(self, include_moveit_configs: bool = True) -> dict[str, Any]:
        """Return all parameters as one mapping."""
        configs = self.to_moveit_configs().to_dict() if include_moveit_configs else {}
        return {**self._parameters, **configs}

    def _values(self, file_path: str | None, name: str) -> dict[str, Any]:
        values = load_yaml(self._package_path / (file_path or f"config/{name}"))
        return values if isinstance(values, dict) else {}

    def _xacro(self, suffix: str, file: Path, mappings: Mapping[str, Any]) -> dict[str, Any]:
        if all(isinstance(value, str) for value in mappings.values()):
            return {self._description + suffix: load_xacro(file, mappings)}
        words: list[str | Substitution] = ["xacro ", str(file)]
        for name, value in mappings.items():
            words += [f" {name}:=", value if isinstance(value, Substitution) else str(value)]
        return {self._description + suffix: ParameterValue(Command(words), value_type=str)}
