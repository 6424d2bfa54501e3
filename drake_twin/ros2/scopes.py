"""Launch configurations and environment variables, and the scopes that save and restore them."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from drake_twin.errors import InputError


class Scopes:
    """The launch configurations and environment variables at hand.

    ``os.environ`` is the environment: the caller restores it afterwards (see `drake_twin.ros2.evaluate`).

    Args:
        configurations: Launch configurations to start with.

    Attributes:
        configurations: Name → value. Files keep references to the mapping, so it is changed in place.
    """

    def __init__(self, configurations: Mapping[str, Any]):
        self.configurations = dict(configurations)
        self._start_environment = dict(os.environ)
        self._configuration_stack: list[dict[str, Any]] = []
        self._environment_stack: list[dict[str, str]] = []

    def environment_additions(self) -> dict[str, str | None]:
        """Return what differs from the environment at the start; None for a variable that was removed."""
        changed: dict[str, str | None] = {
            name: value for name, value in os.environ.items() if self._start_environment.get(name) != value
        }
        changed.update((name, None) for name in self._start_environment if name not in os.environ)
        return changed

    def replace_configurations(self, values: Mapping[str, Any]) -> None:
        """Replace all configurations."""
        self.configurations.clear()
        self.configurations.update(values)

    def push_configurations(self) -> None:
        """Save the launch configurations."""
        self._configuration_stack.append(dict(self.configurations))

    def pop_configurations(self) -> None:
        """Restore the launch configurations that were saved last.

        Raises:
            InputError: If none are saved.
        """
        if not self._configuration_stack:
            raise InputError("PopLaunchConfigurations without PushLaunchConfigurations")
        self.replace_configurations(self._configuration_stack.pop())

    def push_environment(self) -> None:
        """Save the environment variables."""
        self._environment_stack.append(dict(os.environ))

    def pop_environment(self) -> None:
        """Restore the environment variables that were saved last.

        Raises:
            InputError: If none are saved.
        """
        if not self._environment_stack:
            raise InputError("PopEnvironment without PushEnvironment")
        set_environment(self._environment_stack.pop())

    def reset_environment(self) -> None:
        """Restore the environment that the launch was started with."""
        set_environment(self._start_environment)

    @contextmanager
    def scope(self) -> Iterator[None]:
        """Save configurations and environment, and restore them at the end, whatever was pushed in between."""
        depths = len(self._configuration_stack), len(self._environment_stack)
        self.push_configurations()
        self.push_environment()
        try:
            yield
        finally:
            del self._configuration_stack[depths[0] + 1 :]
            del self._environment_stack[depths[1] + 1 :]
            self.pop_configurations()
            self.pop_environment()


def set_environment(values: Mapping[str, str]) -> None:
    """Make ``os.environ`` exactly these variables."""
    for name in [name for name in os.environ if name not in values]:
        del os.environ[name]
    for name, value in values.items():
        if os.environ.get(name) != value:
            os.environ[name] = value
