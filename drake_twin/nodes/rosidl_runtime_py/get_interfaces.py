"""Stand-in for ``rosidl_runtime_py.get_interfaces``: the types that drake_twin knows."""

from collections.abc import Iterable

from drake_twin.messages import interface_types


def get_interface_packages() -> dict[str, list[str]]:
    return {package: names for package in _packages() if (names := _names(package, ("msg", "srv", "action")))}


def get_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    return _found(package_names, ("msg", "srv", "action"))


def get_message_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    return _found(package_names, ("msg",))


def get_service_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    return _found(package_names, ("srv",))


def get_action_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    return _found(package_names, ("action",))


def get_interface_path(interface_name: str) -> str:
    raise NotImplementedError("get_interface_path: types of the twin have no files")


def _packages() -> list[str]:
    return sorted(interface_types.known_packages())


def _names(package: str, kinds: Iterable[str]) -> list[str]:
    return [f"{kind}/{name}" for kind in kinds for name in interface_types.known_names(package, kind)]


def _found(packages: Iterable[str], kinds: Iterable[str]) -> dict[str, list[str]]:
    chosen = list(packages) or _packages()
    for package in chosen:
        if package not in interface_types.known_packages():
            raise LookupError(f"Unknown package '{package}'")
    return {package: names for package in chosen if (names := _names(package, kinds))}
