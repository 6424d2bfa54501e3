"""ROS 2's actions that start nodes or say something about those that follow (``launch_ros.actions``)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.actions import TimerAction
from drake_twin.ros2.entity import Action
from drake_twin.ros2.launched import COMPONENT, NODE, LaunchedProcess, absolute_name, joined_namespace
from drake_twin.ros2.parameters import Parameter, ParameterFile, ParameterValue, evaluate_parameters, typed_value
from drake_twin.ros2.process_actions import Executable, ExecuteLocal, node_ends
from drake_twin.ros2.ros_arguments import split_ros_arguments
from drake_twin.ros2.substitution import SomeSubstitutionsType, normalize_to_list_of_substitutions, perform

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class Node(ExecuteLocal):
    """Starts a ROS executable.

    Args:
        executable: its name.
        package: the package that installs it.
        name: the node's name.
        namespace: its namespace, within those of PushRosNamespace.
        exec_name: the process's name in logs.
        parameters: files, mappings and parameters.
        remappings: (from, to) pairs.
        ros_arguments: what follows ``--ros-args``.
        arguments: the command line's arguments.
    """

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType,
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
        words = [arguments] if isinstance(arguments, str) else list(arguments or ())
        super().__init__(
            process_description=Executable(
                cmd=[executable, *words], prefix=prefix, cwd=cwd, env=env, additional_env=additional_env
            ),
            **kwargs,
        )
        self._package = package
        self._name = name
        self._namespace = namespace
        self._parameters = parameters
        self._remappings = list(remappings or ())
        self._ros_arguments = [normalize_to_list_of_substitutions(word) for word in ros_arguments or ()]

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
        """What it starts, with its substitutions performed."""
        executable, *words = [perform(context, word) for word in self.cmd]
        said = split_ros_arguments([*words, "--ros-args", *(perform(context, word) for word in self._ros_arguments)])
        name = self._performed(context, self._name)
        given = self._performed(context, self._namespace)
        namespace = joined_namespace(context.launch_configurations.get("ros_namespace"), given)
        remappings = [*context.launch_configurations.get("ros_remaps", []), *_pairs(context, self._remappings)]
        return LaunchedProcess(
            kind=NODE,
            package=self._performed(context, self._package),
            executable=executable,
            name=said.name or name or None,
            namespace=namespace if said.namespace is None else joined_namespace(None, said.namespace),
            parameters=(
                *_global_parameters(context),
                *evaluate_parameters(context, self._parameters),
                *said.parameters,
            ),
            remappings=(*remappings, *said.remappings),
            arguments=said.arguments,
            place=self.place or Place(""),
            environment=self.own_environment(context),
            output=self.performed_output(context),
            ends=node_ends(executable),
        )


class LifecycleNode(Node):
    """Starts a node with lifecycle states.

    Args:
        autostart: whether it configures and activates itself.
    """

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType = "",
        autostart: Any = False,
        **kwargs: Any,
    ):
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.autostart = autostart
        self.is_lifecycle = True

    def execute(self, context: LaunchContext) -> None:
        """Starts it."""
        super().execute(context)
        nodes = context.get_locals_as_dict().get("lifecycle_nodes", [])
        context.extend_globals({"lifecycle_nodes": [*nodes, self]})


class LifecycleTransition(Action):
    """Asks lifecycle nodes for transitions; the twin does not run them."""

    def __init__(self, *, lifecycle_node_names: Iterable[Any], transition_ids: Iterable[Any], **kwargs: Any):
        super().__init__(**kwargs)


class ComposableNode:
    """A node that is loaded into a container (``launch_ros.descriptions.ComposableNode``)."""

    def __init__(
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: Any = None,
        remappings: Iterable[Any] | None = None,
        extra_arguments: Any = None,
        condition: Any = None,
    ):
        self.package, self.plugin, self.name, self.namespace = package, plugin, name, namespace
        self.parameters, self.remappings = parameters, list(remappings or ())
        self.extra_arguments, self.condition = extra_arguments, condition

    @property
    def node_plugin(self) -> Any:
        """The plugin."""
        return self.plugin

    @property
    def node_name(self) -> Any:
        """The name."""
        return self.name


ComposableLifecycleNode = ComposableNode


class LoadComposableNodes(Action):
    """Loads nodes into a container."""

    def __init__(self, *, composable_node_descriptions: Iterable[Any], target_container: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.descriptions = list(composable_node_descriptions)
        self.target_container = target_container

    def execute(self, context: LaunchContext) -> None:
        """Loads them."""
        base = context.launch_configurations.get("ros_namespace")
        target = self.target_container
        if isinstance(target, Node):
            container = target.node_name if target.started is not None else None
        else:
            container = absolute_name(perform(context, target), joined_namespace(base, None))
        for description in self.descriptions:
            if description.condition is not None and not description.condition.evaluate(context):
                continue
            namespace = None if description.namespace is None else perform(context, description.namespace)
            remappings = [
                *context.launch_configurations.get("ros_remaps", []),
                *_pairs(context, description.remappings),
            ]
            context.start(
                LaunchedProcess(
                    kind=COMPONENT,
                    package=perform(context, description.package),
                    executable=perform(context, description.plugin),
                    name=None if description.name is None else perform(context, description.name),
                    namespace=joined_namespace(base, namespace),
                    parameters=(*_global_parameters(context), *evaluate_parameters(context, description.parameters)),
                    remappings=tuple(remappings),
                    place=self.place or Place(""),
                    container=container,
                )
            )


class ComposableNodeContainer(Node):
    """Starts a container and loads nodes into it."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType = "",
        composable_node_descriptions: Iterable[Any] | None = None,
        **kwargs: Any,
    ):
        super().__init__(name=name, namespace=namespace, **{"executable": "component_container", **kwargs})
        self.descriptions = list(composable_node_descriptions or ())

    def execute(self, context: LaunchContext) -> Any:
        """Starts it and loads them."""
        super().execute(context)
        load = LoadComposableNodes(composable_node_descriptions=self.descriptions, target_container=self)
        load.place = self.place
        return [load]


class PushRosNamespace(Action):
    """Puts the nodes that follow, to the end of the scope, into a namespace."""

    def __init__(self, namespace: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Puts them there."""
        base = context.launch_configurations.get("ros_namespace")
        context.launch_configurations["ros_namespace"] = joined_namespace(base, perform(context, self.namespace))


class SetParameter(Action):
    """Gives all nodes that follow, to the end of the scope, a parameter."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = value

    def execute(self, context: LaunchContext) -> None:
        """Gives it."""
        name = perform(context, self.name)
        value = self.value.evaluate(context) if isinstance(self.value, ParameterValue) else self.value
        _add_global(context, "global_params", (name, typed_value(context, value, f"parameter {name!r}")))


class SetParametersFromFile(Action):
    """Gives all nodes that follow, to the end of the scope, a file of parameters."""

    def __init__(self, filename: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.filename = filename

    def execute(self, context: LaunchContext) -> None:
        """Gives it."""
        file = self.filename if isinstance(self.filename, ParameterFile) else ParameterFile(self.filename)
        _add_global(context, "global_params", file.read(context))


class SetUseSimTime(SetParameter):
    """Tells all nodes that follow whether they use simulation time."""

    def __init__(self, value: Any, **kwargs: Any):
        super().__init__("use_sim_time", value, **kwargs)


class SetRemap(Action):
    """Gives all nodes that follow, to the end of the scope, a remapping."""

    def __init__(self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.src = normalize_to_list_of_substitutions(src)
        self.dst = normalize_to_list_of_substitutions(dst)

    def execute(self, context: LaunchContext) -> None:
        """Gives it."""
        _add_global(context, "ros_remaps", (perform(context, self.src), perform(context, self.dst)))


class SetROSLogDir(Action):
    """Sets the folder of the log files."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.new_log_dir = new_log_dir

    def execute(self, context: LaunchContext) -> None:
        """Sets it."""
        context.environment["ROS_LOG_DIR"] = perform(context, self.new_log_dir)


class RosTimer(TimerAction):
    """A timer on ROS's clock, which here is simulation time like every timer."""


def _add_global(context: LaunchContext, key: str, item: Any) -> None:
    context.launch_configurations[key] = [*context.launch_configurations.get(key, []), item]


def _global_parameters(context: LaunchContext) -> list[Any]:
    items = context.launch_configurations.get("global_params", [])
    return [{item[0]: item[1]} if isinstance(item, tuple) else item for item in items]


def _pairs(context: LaunchContext, remappings: Iterable[Any]) -> list[tuple[str, str]]:
    pairs = []
    for pair in remappings:
        if isinstance(pair, str) or not isinstance(pair, Iterable) or len(list(pair)) != 2:
            raise InputError(f"a remapping is a pair (from, to), and this is {pair!r}")
        source, target = pair
        pairs.append((perform(context, source), perform(context, target)))
    return pairs


__all__ = [
    "ComposableLifecycleNode",
    "ComposableNode",
    "ComposableNodeContainer",
    "LifecycleNode",
    "LifecycleTransition",
    "LoadComposableNodes",
    "Node",
    "Parameter",
    "PushRosNamespace",
    "RosTimer",
    "SetParameter",
    "SetParametersFromFile",
    "SetROSLogDir",
    "SetRemap",
    "SetUseSimTime",
]
