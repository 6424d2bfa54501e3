"""ROS 2's actions that are not about processes or includes (``launch.actions``)."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.entity import Action, as_entities, visit_list
from drake_twin.ros2.events import ChangeState, handle_in
from drake_twin.ros2.events import Shutdown as ShutdownEvent
from drake_twin.ros2.launched import LaunchArgument
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    describe_all,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class DeclareLaunchArgument(Action):
    """Declares an argument of the launch file.

    Args:
        name: its name.
        default_value: its default; required without one.
        description: what it is for.
        choices: the accepted values.
    """

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **kwargs: Any,
    ):
        super().__init__(condition=kwargs.pop("condition", None))
        if kwargs:
            raise TypeError(f"DeclareLaunchArgument got an unexpected keyword argument {next(iter(kwargs))!r}")
        self.name = name
        self.default_value = None
        if default_value is not None:
            self.default_value = normalize_to_list_of_substitutions(
                str(default_value) if isinstance(default_value, bool | int | float) else default_value
            )
        self.description = description or ""
        self.choices = None if choices is None else [str(choice) for choice in choices]

    def declared(self) -> LaunchArgument:
        """The argument as data."""
        default = None if self.default_value is None else describe_all(self.default_value)
        return LaunchArgument(self.name, default, self.description, tuple(self.choices or ()), self.place)

    def execute(self, context: LaunchContext) -> None:
        """Sets the default where there is no value yet.

        Raises:
            InputError: no value and no default, or a value that is not one of the choices.
        """
        context.declared.add(self.name)
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise InputError(
                    f"the required argument {self.name!r} has no value"
                    + (f" ({self.description})" if self.description else "")
                )
            context.launch_configurations[self.name] = perform_substitutions(context, self.default_value)
        value = context.launch_configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise InputError(
                f"the argument {self.name!r} is {value!r}, which is not one of its choices",
                valid=self.choices,
                value=str(value),
            )


class SetLaunchConfiguration(Action):
    """Sets a launch configuration."""

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(str(value) if isinstance(value, bool | int | float) else value)

    def execute(self, context: LaunchContext) -> None:
        """Sets it."""
        context.launch_configurations[perform_substitutions(context, self.name)] = perform_substitutions(
            context, self.value
        )


class UnsetLaunchConfiguration(Action):
    """Removes a launch configuration."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Removes it."""
        context.launch_configurations.pop(perform_substitutions(context, self.name), None)


class PushLaunchConfigurations(Action):
    """Opens a scope of launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Opens it."""
        context.push_configurations()


class PopLaunchConfigurations(Action):
    """Leaves a scope of launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Leaves it."""
        context.pop_configurations()


class ResetLaunchConfigurations(Action):
    """Forgets all launch configurations but those given."""

    def __init__(self, launch_configurations: Mapping[Any, Any] | None = None, **kwargs: Any):
        super().__init__(**kwargs)
        self.launch_configurations = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Forgets the others."""
        kept = {perform(context, name): perform(context, value) for name, value in self.launch_configurations.items()}
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)


class SetEnvironmentVariable(Action):
    """Sets an environment variable."""

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        """Sets it."""
        context.environment[perform_substitutions(context, self.name)] = perform_substitutions(context, self.value)


class AppendEnvironmentVariable(SetEnvironmentVariable):
    """Appends to an environment variable, or prepends."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: Any = False,
        separator: SomeSubstitutionsType = os.pathsep,
        **kwargs: Any,
    ):
        super().__init__(name, value, **kwargs)
        self.prepend = prepend
        self.separator = separator

    def execute(self, context: LaunchContext) -> None:
        """Appends or prepends."""
        name, value = perform_substitutions(context, self.name), perform_substitutions(context, self.value)
        if context.environment.get(name):
            prepend = self.prepend
            if not isinstance(prepend, bool):
                prepend = perform(context, prepend).strip().lower() in ("true", "1")
            parts = [value, context.environment[name]] if prepend else [context.environment[name], value]
            value = perform(context, self.separator).join(parts)
        context.environment[name] = value


class UnsetEnvironmentVariable(Action):
    """Removes an environment variable."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Removes it."""
        context.environment.pop(perform_substitutions(context, self.name), None)


class PushEnvironment(Action):
    """Opens a scope of environment variables."""

    def execute(self, context: LaunchContext) -> None:
        """Opens it."""
        context.push_environment()


class PopEnvironment(Action):
    """Leaves a scope of environment variables."""

    def execute(self, context: LaunchContext) -> None:
        """Leaves it."""
        context.pop_environment()


class ResetEnvironment(Action):
    """Puts the environment back to what the launch was started with."""

    def execute(self, context: LaunchContext) -> None:
        """Puts it back."""
        context.reset_environment()


class GroupAction(Action):
    """Actions with configurations of their own.

    Args:
        actions: the actions.
        scoped: whether what they set ends with the group.
        forwarding: whether they see what is set outside.
        launch_configurations: configurations to set first.
    """

    def __init__(
        self,
        actions: Iterable[Any],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.actions = as_entities(actions)
        self.scoped = scoped
        self.forwarding = forwarding
        self.launch_configurations = dict(launch_configurations or {})

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """The actions."""
        return [("the group's condition", self.actions)] if self.condition is not None else []

    def describe_sub_entities(self) -> list[Any]:
        """The actions."""
        return self.actions if self.condition is None else []

    def get_sub_entities(self) -> list[Any]:
        """The actions."""
        return self.actions

    def execute(self, context: LaunchContext) -> None:
        """Visits the actions."""
        if self.scoped:
            with context.scope():
                self._visit(context)
        else:
            self._visit(context)

    def _visit(self, context: LaunchContext) -> None:
        values = {perform(context, name): perform(context, value) for name, value in self.launch_configurations.items()}
        if self.scoped and not self.forwarding:
            context.launch_configurations.clear()
            context.reset_environment()
        context.launch_configurations.update(values)
        visit_list(self.actions, context)


class OpaqueFunction(Action):
    """Calls a function of the launch file with the context; it may return entities to visit."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **left_over_kwargs: Any,
    ):
        super().__init__(**left_over_kwargs)
        if not callable(function):
            raise TypeError(f"OpaqueFunction needs a function, and {function!r} is none")
        self.function = function
        self.args = tuple(args or ())
        self.kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Any:
        """Calls it."""
        return self.function(context, *self.args, **self.kwargs)


class OpaqueCoroutine(Action):
    """Runs a coroutine of the launch file to its end."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        **left_over_kwargs: Any,
    ):
        super().__init__(**left_over_kwargs)
        self.coroutine = coroutine
        self.args = tuple(args or ())
        self.kwargs = dict(kwargs or {})
        self.ignore_context = ignore_context

    def execute(self, context: LaunchContext) -> None:
        """Runs it."""
        first = () if self.ignore_context else (context,)
        asyncio.run(self.coroutine(*first, *self.args, **self.kwargs))


class RegisterEventHandler(Action):
    """Registers an event handler; the configurations of this moment are those its actions see."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Registers it."""
        context.register_event_handler(self.event_handler)

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """What the handler visits."""
        return [("the event", list(getattr(self.event_handler, "entities", ())))]


class UnregisterEventHandler(Action):
    """Removes an event handler."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Removes it."""
        context.unregister_event_handler(self.event_handler)


class TimerAction(Action):
    """Actions that are executed after a time.

    Args:
        period: simulated seconds.
        actions: the actions.
    """

    def __init__(self, *, period: Any, actions: Iterable[Any], cancel_on_shutdown: Any = True, **kwargs: Any):
        super().__init__(**kwargs)
        self.period = period
        self.actions = as_entities(actions)
        self._canceled = False

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """The actions."""
        return [("the timer", self.actions)]

    def cancel(self) -> None:
        """Executes the actions no more."""
        self._canceled = True

    def execute(self, context: LaunchContext) -> None:
        """Waits, in simulation time.

        Raises:
            InputError: the period is not a number of seconds.
        """
        captured = context.snapshot()

        def due() -> None:
            if not self._canceled:
                context.run_captured(captured, self.place, lambda: visit_list(self.actions, context))

        context.after(_seconds(context, self.period), due)


class CancelTimer(Action):
    """Cancels a timer."""

    def __init__(self, timer: TimerAction, **kwargs: Any):
        super().__init__(**kwargs)
        self.timer = timer

    def execute(self, context: LaunchContext) -> None:
        """Cancels it."""
        self.timer.cancel()


class ForLoop(Action):
    """Calls a function for 0, 1, … and visits what it returns."""

    def __init__(
        self,
        length: SomeSubstitutionsType,
        *,
        function: Callable[..., Any] | None = None,
        name: str = "",
        actions: Any = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.length = normalize_to_list_of_substitutions(str(length) if isinstance(length, int) else length)
        self.function = function
        self.actions = actions
        self.name = name

    def execute(self, context: LaunchContext) -> None:
        """Visits what each round returns."""
        text = perform_substitutions(context, self.length)
        try:
            length = int(text)
        except ValueError:
            raise InputError(f"the loop's length is {text!r}, which is no whole number") from None
        for index in range(length):
            _loop_round(context, {self.name or "index": index}, self.function and self.function(index), self.actions)


class ForEach(Action):
    """Calls a function for each set of values of a list, and visits what it returns.

    Args:
        input_values: sets separated by ``;``, each a YAML mapping's content: ``{name: 'a', x: 1}; {name: 'b', x: 2}``.
        function: takes the values by name.
    """

    def __init__(
        self,
        input_values: SomeSubstitutionsType,
        *,
        function: Callable[..., Any] | None = None,
        actions: Any = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.input_values = normalize_to_list_of_substitutions(input_values)
        self.function = function
        self.actions = actions

    def execute(self, context: LaunchContext) -> None:
        """Visits what each round returns."""

        for part in perform_substitutions(context, self.input_values).split(";"):
            if part.strip():
                values = load_yaml(part)
                if not isinstance(values, dict):
                    raise InputError(f"{part.strip()!r} is not a set of values such as {{name: 'a', x: 1}}")
                _loop_round(context, values, self.function and self.function(**values), self.actions)


def _loop_round(context: LaunchContext, values: Mapping[str, Any], returned: Any, actions: Any) -> None:
    with context.restored(context.snapshot()):
        context.extend_locals({"for_each": values})
        visit_list(as_entities(returned) or as_entities(actions), context)


class LogInfo(Action):
    """Says something."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.msg = normalize_to_list_of_substitutions(str(msg) if isinstance(msg, bool | int | float) else msg)

    def execute(self, context: LaunchContext) -> None:
        """Says it."""
        context.log.append(perform_substitutions(context, self.msg))


class Log(LogInfo):
    """Says something at a level."""

    def __init__(self, *, msg: SomeSubstitutionsType, level: SomeSubstitutionsType = "INFO", **kwargs: Any):
        super().__init__(msg=msg, **kwargs)
        self.level = level

    def execute(self, context: LaunchContext) -> None:
        """Says it."""
        context.log.append(f"[{perform(context, self.level)}] {perform_substitutions(context, self.msg)}")


class LogWarning(Log):
    """Warns."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(msg=msg, level="WARNING", **kwargs)


class LogError(Log):
    """Says that something is wrong."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(msg=msg, level="ERROR", **kwargs)


class LogDebug(Log):
    """Says something that seldom matters."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(msg=msg, level="DEBUG", **kwargs)


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Puts it behind the events that wait."""
        event = self.event
        if isinstance(event, ChangeState):
            from drake_twin.ros2.lifecycle import change_state

            context.after(0.0, lambda: change_state(context, event))
        else:
            context.after(0.0, lambda: handle_in(context, event))


class Shutdown(EmitEvent):
    """Ends the launch."""

    def __init__(self, *, reason: SomeSubstitutionsType = "reason not given", **kwargs: Any):
        super().__init__(event=ShutdownEvent(), **kwargs)
        self.reason = normalize_to_list_of_substitutions(reason)

    def execute(self, context: LaunchContext) -> None:
        """Ends it."""
        self.event = ShutdownEvent(reason=perform_substitutions(context, self.reason))
        super().execute(context)


def _seconds(context: LaunchContext, period: Any) -> float:
    value = period if isinstance(period, int | float) else perform(context, period)
    try:
        return float(value)
    except ValueError:
        raise InputError(f"the timer's period is {value!r}, which is no number of seconds") from None
