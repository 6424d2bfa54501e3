"""The assignment of requests for controllers to robots' controller managers."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from drake_twin.findings import Finding, Kind
from drake_twin.from_launch.launched_controllers import ControllerRequest
from drake_twin.from_launch.launched_robots import LaunchedRobot


def requests_by_robot(
    robots: Sequence[LaunchedRobot],
    requests: Sequence[ControllerRequest],
    findings: list[Finding],
    log: list[str],
    absent: Collection[str] = (),
) -> dict[str, list[ControllerRequest]]:
    """Return the requests to each robot's controller manager, by the robot's name.

    Args:
        robots: The robots.
        requests: The requests of all spawners.
        findings: Is extended by a finding for each request to an unknown controller manager.
        log: Is extended by a line for each request that goes to a controller manager of another name.
        absent: The controller managers that the launch file starts and the twin does not.
    """
    controlled = [robot for robot in robots if robot.controller_manager is not None]
    found: dict[str, list[ControllerRequest]] = {}
    for request in requests:
        owners = [robot for robot in controlled if robot.controller_manager == request.manager]
        namespace = request.manager.rpartition("/")[0]
        if request.manager not in absent:  # a manager of another name is meant if it is the only one
            owners = owners or [robot for robot in controlled if namespace.strip("/") == robot.name]
            owners = owners or (controlled if len(controlled) == 1 else [])
        if not owners:
            known = ", ".join(str(robot.controller_manager) for robot in controlled) or "none"
            why = f"{request.process.what}: unknown {request.manager}; the launch file has {known}"
            if request.manager in absent:
                why = f"{request.process.what}: {request.manager} is not started"
            what = f"controller {request.name} ({why})"
            findings.append(Finding.at(Kind.NOT_STARTED, what, request.process.place))
            continue
        manager = str(owners[0].controller_manager)
        assumed = f"{request.process.what} waits for {request.manager}; {manager} is used instead"
        if manager != request.manager and assumed not in log:
            log.append(assumed)
        found.setdefault(owners[0].name, []).append(request)
    return {name: _settled(items) for name, items in found.items()}


def _settled(requests: Iterable[ControllerRequest]) -> list[ControllerRequest]:
    """Return the last request for each controller; an unspawner removes it."""
    last: dict[str, ControllerRequest] = {}
    for request in requests:
        if request.unload:
            last.pop(request.name, None)
        else:
            before = last.pop(request.name, None)
            files = (*(before.parameter_files if before else ()), *request.parameter_files)
            remappings = (*(before.remappings if before else ()), *request.remappings)
            parameters = {**(before.parameters if before else {}), **request.parameters}
            last[request.name] = replace(request, parameter_files=files, remappings=remappings, parameters=parameters)
    return list(last.values())
