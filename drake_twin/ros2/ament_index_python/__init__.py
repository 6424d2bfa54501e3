"""Stand-ins for ``ament_index_python``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "packages": "PackageNotFoundError get_package_prefix get_package_share_directory get_package_share_path"
        " get_packages_with_prefixes",
        "resources": "InvalidResourceNameError InvalidResourceTypeNameError RESOURCE_INDEX_SUBFOLDER get_resource"
        " get_resource_types get_resources get_search_paths has_resource",
    },
)
