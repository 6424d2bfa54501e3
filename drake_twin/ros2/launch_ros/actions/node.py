"""Starts a ROS executable."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.findings import Place
from drake_twin.ros2.command_lines import split_command_line
from drake_twin.ros2.ending_commands import node_ends
from drake_twin.ros2.launch.actions.execute_local import ExecuteLocal, performed
from drake_twin.ros2.launch.actions.execute_process import process_arguments
from drake_twin.ros2.launch.descriptions.executable import Executable
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launch_ros.utilities.evaluate_parameters import evaluate_parameters
from drake_twin.ros2.launched import NODE, LaunchedProcess, joined_namespace
from drake_twin.ros2.node_elements import parse_parameters, parse_remappings
from drake_twin.ros2.node_settings import global_parameters, remapping_pairs
from drake_twin.ros2.ros_arguments import of_node, split_ros_arguments

# What ROS knows and the twin ignores.
_IGNORED = ("exec_name", "machine", "autostart")
_OLD_NAMES = ("node_executable", "node_name", "node_namespace")  # of ROS 2 Foxy
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


@expose_action("node")
class Node(ExecuteLocal):
    """Starts a ROS executable.

    Args:
        executable: Its name.
        package: The package that installs it.
        name: The node's name.
        namespace: Its namespace, within those of PushRosNamespace.
        exec_name: The process's name in logs.
        parameters: Files, mappings and parameters.
        remappings: (from, to) pairs.
        ros_arguments: What follows ``--ros-args``.
        arguments: The command line's arguments.
        prefix: See `Executable`, as the next three.
        cwd: The working directory.
        env: The environment variables.
        additional_env: Environment variables beside the present ones.
    """

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType | None = None,
        package: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        exec_name: SomeSubstitutionsType | None = None,
        parameters: Any = None,
        remappings: Iterable[Any] | None = None,
        ros_arguments: Iterable[SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
        prefix: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ):
        old = {name.removeprefix("node_"): kwargs.pop(name) for name in _OLD_NAMES if name in kwargs}
        executable = executable or old.get("executable")
        name, namespace = name or old.get("name"), namespace or old.get("namespace")
        if executable is None:
            raise TypeError("Node.__init__() missing 1 required keyword-only argument: 'executable'")
        command = Executable(
            cmd=[executable], arguments=arguments, prefix=prefix, cwd=cwd, env=env, additional_env=additional_env
        )
        super().__init__(process_description=command, **kwargs)
        self._old_names = [f"node_{name}" for name in old]
        self._package = package
        self._name = name
        self._namespace = namespace
        self._parameters = parameters
        self._remappings = list(remappings or ())
        self._ros_arguments = [normalize_to_list_of_substitutions(word) for word in ros_arguments or ()]

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<node>``."""
        _, arguments = super().parse(entity, parser)
        arguments |= process_arguments(entity, parser)
        given = parser.parse_optional(entity, "pkg", "name", "node-name", "namespace", "args", "ros_args")
        for name in (*_IGNORED, "shell"):
            entity.raw(name)
        for tag in ("composable_node", "extra_arg"):
            entity.children_named(tag)
        named = {
            "package": given.get("pkg"),
            "name": given.get("name") or given.get("node_name"),
            "namespace": given.get("namespace"),
        }
        return cls, {
            **arguments,
            **{name: value for name, value in named.items() if value is not None},
            "executable": parser.parse_required(entity, "exec")["exec"],
            "arguments": split_command_line(given.get("args", ())),
            "ros_arguments": split_command_line(given.get("ros_args", ())),
            "parameters": parse_parameters(entity, parser),
            "remappings": parse_remappings(entity, parser),
        }

    @property
    def node_package(self) -> Any:
        """The package, as given."""
        return self._package

    @property
    def node_executable(self) -> Any:
        """The executable, as given."""
        return self.process_description.cmd[0]

    @property
    def node_name(self) -> str:
        """The full name; known once the action has been executed."""
        if self.started is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self.started.full_name

    @property
    def expanded_node_namespace(self) -> str:
        """The full namespace; known once the action has been executed."""
        if self.started is None:
            raise RuntimeError("cannot access 'expanded_node_namespace' before executing action")
        return self.started.namespace

    @property
    def what(self) -> str:
        """``package/executable``."""
        if self.started is not None or self._package is None:
            return super().what
        parts = [normalize_to_list_of_substitutions(part) for part in (self._package, self.node_executable)]
        return "/".join("".join(item.describe().strip("'") for item in part) for part in parts)

    def prepare(self, context: LaunchContext) -> LaunchedProcess:
        """Return what it starts, with its substitutions performed."""
        for old in self._old_names:
            context.refused_by_ros(f"{old} is a keyword of ROS 2 Foxy; it is {old.removeprefix('node_')} now")
        executable, *words = [context.perform_substitution(word) for word in self.cmd]
        ros_words = [context.perform_substitution(word) for word in self._ros_arguments]
        split = split_ros_arguments([*words, "--ros-args", *ros_words])
        name = performed(context, self._name)
        given = performed(context, self._namespace)
        if name is not None and not _NAME.fullmatch(name):
            context.refused_by_ros(f"a node cannot have the name {name!r}")
        if given and not all(_NAME.fullmatch(part) for part in given.strip("/").split("/") if given.strip("/")):
            context.refused_by_ros(f"a namespace cannot be {given!r}")
        namespace = joined_namespace(context.launch_configurations.get("ros_namespace"), given)
        return LaunchedProcess(
            kind=NODE,
            package=performed(context, self._package),
            executable=executable,
            name=split.name or name or None,
            namespace=namespace if split.namespace is None else joined_namespace(None, split.namespace),
            parameters=(
                *global_parameters(context),
                *evaluate_parameters(context, self._parameters),
                *of_node(split.parameters, split.name or name),
            ),
            remappings=(*remapping_pairs(context, self._remappings), *split.remappings),
            arguments=split.arguments,
            place=self.place or Place(""),
            environment=self.own_environment(context),
            output=self.performed_output(context),
            ends=node_ends(executable),
            not_done=self.not_done(context),
            respawn=self.performed_respawn(context),
        )
