"""``ament_index_python.resources`` for launch files: the packages of the twin's index, and installed workspaces."""

from drake_twin.ros2.ament_index_python.packages import get_package_prefix, get_packages_with_prefixes
from drake_twin.ros2.ament_index_python.resource_index import (
    RESOURCE_INDEX_SUBFOLDER,
    InvalidResourceNameError,
    InvalidResourceTypeNameError,
    ResourceIndex,
    get_search_paths,
)
from drake_twin.ros2.evaluation import current_context

__all__ = [
    "RESOURCE_INDEX_SUBFOLDER",
    "InvalidResourceNameError",
    "InvalidResourceTypeNameError",
    "get_resource",
    "get_resource_types",
    "get_resources",
    "get_search_paths",
    "has_resource",
]


def _prefix(package: str) -> str | None:
    context = current_context()
    if context.packages.present(package, context.current_launch_file) is None:
        return None
    return get_package_prefix(package)


_INDEX = ResourceIndex(_prefix, get_packages_with_prefixes)
get_resource, has_resource = _INDEX.get_resource, _INDEX.has_resource
get_resources, get_resource_types = _INDEX.get_resources, _INDEX.get_resource_types
