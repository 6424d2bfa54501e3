"""The classes of messages and services that the packages of a ROS 2 have, by the names of their types."""

import importlib
from typing import Any

_PARTS = {"SendGoal": "SendGoalService", "GetResult": "GetResultService", "FeedbackMessage": "FeedbackMessage"}


class UnusableTypeError(Exception):
    """Raised for a type that this ROS 2 does not have, or has with other fields."""


def class_of(name: str) -> Any:
    """Return the class of a message, of a service or of a part of one, which this machine's packages have.

    Raises:
        UnusableTypeError: If they do not.
    """
    package, kind, own = name.split("/")
    try:
        module = importlib.import_module(f"{package}.{kind}")
    except ModuleNotFoundError:
        raise UnusableTypeError(f"the package {package} is not installed") from None
    except Exception as error:
        raise UnusableTypeError(f"the package {package} cannot be imported ({type(error).__name__}: {error})") from None
    if hasattr(module, own):
        return getattr(module, own)
    whole, _, part = own.rpartition("_")
    if not whole:
        raise UnusableTypeError(f"the package {package} has no {kind}/{own}")
    found = class_of(f"{package}/{kind}/{whole}")
    return getattr(found.Impl, _PARTS[part]) if part in _PARTS else getattr(found, part)


def check_fields(types: dict[str, list[list[str]]]) -> None:
    """Check that messages have the same fields here as for the twin.

    Args:
        types: The fields of each type, as `get_fields_and_field_types` has them.

    Raises:
        UnusableTypeError: If one has others.
    """
    for name, fields in types.items():
        here = {key: kind.replace(" ", "") for key, kind in class_of(name).get_fields_and_field_types().items()}
        if list(here.items()) != [tuple(field) for field in fields]:
            ours = dict(fields)
            differ = [key for key in (*ours, *here) if ours.get(key) != here.get(key)] or list(here)
            raise UnusableTypeError(f"{name} is another one, in which {differ[0]} differs")
