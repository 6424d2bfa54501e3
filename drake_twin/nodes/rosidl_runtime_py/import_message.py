"""Stand-in for ``rosidl_runtime_py.import_message``."""

from importlib import import_module
from typing import Any

from drake_twin.nodes.rosidl_parser.definition import NamespacedType


def import_message_from_namespaced_type(message_type: NamespacedType) -> Any:
    """Return the class of a message, a service or an action.

    Raises:
        ModuleNotFoundError: If its package does not exist, or has none of its kind.
        AttributeError: If the package lacks it.
        ValueError: If the name has no package.
    """
    module, name = import_module(".".join(message_type.namespaces)), message_type.name
    if name.endswith("_FeedbackMessage"):
        return getattr(module, name.removesuffix("_FeedbackMessage")).Impl.FeedbackMessage
    return getattr(module, name)
