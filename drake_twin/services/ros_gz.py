"""The services of gz sim's world, as ros_gz bridges them (``ros_gz_interfaces``)."""

from typing import Any

from drake_twin.errors import InputError, TwinError
from drake_twin.services import entities
from drake_twin.services.registry import Fields, Later, twin_service
from drake_twin.services.running import play, refused, reset, steps, tried
from drake_twin.twin.twin import Twin

_MODEL, _NONE = 2, 0  # ros_gz_interfaces/msg/Entity


@twin_service("ros_gz_interfaces/srv/SpawnEntity", "/world/{world}/create", between_advances=True)
def _create(twin: Twin, request: Any) -> Fields:
    return tried("create", lambda: _spawn(twin, request.entity_factory))


def _spawn(twin: Twin, factory: Any) -> None:
    if factory.clone_name:
        raise InputError(f"{factory.clone_name!r} cannot be cloned: give its file or description")
    name = entities.free_name(twin, factory.name) if factory.allow_renaming else factory.name
    source = {"text": factory.sdf} if factory.sdf else {"uri": factory.sdf_filename}
    entities.spawn(twin, name, **source, pose=factory.pose, frame=factory.relative_to)


@twin_service("ros_gz_interfaces/srv/DeleteEntity", "/world/{world}/remove", between_advances=True)
def _remove(twin: Twin, request: Any) -> Fields:
    return tried("remove", lambda: twin.entities.delete(_name(request.entity)))


@twin_service("ros_gz_interfaces/srv/SetEntityPose", "/world/{world}/set_pose")
def _set_pose(twin: Twin, request: Any) -> Fields:
    return tried("set_pose", lambda: entities.set_state(twin, _name(request.entity), pose=request.pose))


@twin_service("ros_gz_interfaces/srv/ControlWorld", "/world/{world}/control", between_advances=True)
def _control(twin: Twin, request: Any) -> Later:
    """Do what gz does: reset, then pause or play, then step."""
    control = request.world_control
    try:
        run_to = control.run_to_sim_time
        if control.reset.time_only or control.reset.model_only or run_to.sec or run_to.nanosec:
            raise InputError("a reset of time or models alone, and run_to_sim_time, are not supported")
        if control.reset.all:
            reset(twin)
        number = control.multi_step or int(control.step)
        if control.pause or number:
            twin.pause()
        else:
            play(twin)
        if number:
            yield from steps(twin, number)
    except TwinError as error:
        return refused("control", error, "success")
    return {"success": True}


def _name(entity: Any) -> str:
    """Return the name of a model.

    Raises:
        InputError: If the message names something else.
    """
    if entity.type not in (_MODEL, _NONE) or not entity.name:
        raise InputError("only models can be addressed, and by their names")
    return str(entity.name)
