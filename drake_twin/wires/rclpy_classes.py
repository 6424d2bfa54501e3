"""The classes of messages and services that the packages of a ROS 2 have, by the names of their types."""

import importlib
from typing import Any

_PARTS = {"SendGoal": "SendGoalService", "GetResult": "GetResultService", "FeedbackMessage": "FeedbackMessage"}


class UnusableTypeError(Exception):
    """Raised for a type that this ROS 2 does not have, or has with other fields.

    Args:
        text: What is wrong.
        package: The package that is not installed.
    """

    def __init__(self, text: str, package: str = ""):
        super().__init__(text)
        self.package = package


def class_of(name: str) -> Any:
    """Return the class of a message, of a service or of a part of one, which this machine's packages have.

    Raises:
        UnusableTypeError: If they do not.
    """
    package, kind, own = name.split("/")
    try:
        module = importlib.import_module(f"{package}.{kind}")
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name in (package, f"{package}.{kind}"):
            raise UnusableTypeError(f"the package {package} is not installed", package) from None
        raise UnusableTypeError(f"the package {package} cannot be imported ({type(error).__name__}: {error})") from None
    if hasattr(module, own):
        return getattr(module, own)
    whole, _, part = own.rpartition("_")
    if not whole:
        raise UnusableTypeError(f"the package {package} has no {kind}/{own}")
    found = class_of(f"{package}/{kind}/{whole}")
    return getattr(found.Impl, _PARTS[part]) if part in _PARTS else getattr(found, part)


def check_fields(types: dict[str, list[tuple[str, str]]]) -> None:
    """Check that messages have the same fields here as for the twin.

    Args:
        types: The fields of each type, as `get_fields_and_field_types` has them.

    Raises:
        UnusableTypeError: If one has others.
    """
    for name, fields in types.items():
        theirs = {key: kind.replace(" ", "") for key, kind in class_of(name).get_fields_and_field_types().items()}
        ours = dict(fields)
        if list(theirs.items()) != list(ours.items()):
            raise UnusableTypeError(f"the {name} of this ROS 2 is another one: {_difference(ours, theirs)}")


def _difference(ours: dict[str, str], theirs: dict[str, str]) -> str:
    for key in {**ours, **theirs}:
        if key not in theirs:
            return f"it has no field {key}"
        if key not in ours:
            return f"it has a field {key}, too"
        if ours[key] != theirs[key]:
            return f"its field {key} is of type {theirs[key]}, not {ours[key]}"
    return "its fields have another order"
