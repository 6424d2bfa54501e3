"""The services of Gazebo classic's ROS 2 plugins (``gazebo_ros_factory``, ``_state``, ``_init``)."""

from collections.abc import Callable
from typing import Any

from drake_twin.errors import TwinError
from drake_twin.messages import header
from drake_twin.services import entities
from drake_twin.services.registry import Fields, twin_service
from drake_twin.services.running import play, refused, reset, tried
from drake_twin.twin.twin import Twin

_NODE = "/gazebo"


@twin_service("gazebo_msgs/srv/SpawnEntity", "/spawn_entity", _NODE, between_advances=True)
def _spawn_entity(twin: Twin, request: Any) -> Fields:
    name, source = request.name, {"text": request.xml, "namespace": request.robot_namespace}
    frame, pose = request.reference_frame, request.initial_pose
    spawned = f"SpawnEntity: Successfully spawned entity [{name}]"
    if not name:  # as in gazebo_ros_factory.cpp, which does not know the name that Gazebo chooses
        spawned = "Successfully sent factory message to Gazebo."
    return _status(lambda: entities.spawn(twin, name, **source, pose=pose, frame=frame), spawned)


@twin_service("gazebo_msgs/srv/DeleteEntity", "/delete_entity", _NODE, between_advances=True)
def _delete_entity(twin: Twin, request: Any) -> Fields:
    return _status(lambda: twin.entities.delete(request.name), f"Successfully deleted entity [{request.name}]")


def _status(do: Callable[[], object], done: str) -> Fields:
    try:
        do()
        return {"success": True, "status_message": done}
    except TwinError as error:
        return {"success": False, "status_message": str(error)}


@twin_service("gazebo_msgs/srv/GetModelList", "/get_model_list", _NODE)
def _get_model_list(twin: Twin, request: Any) -> Fields:
    return {"header": header(twin.time, "world"), "model_names": entities.entity_names(twin), "success": True}


@twin_service("gazebo_msgs/srv/GetEntityState", "/get_entity_state", _NODE)
@twin_service("gazebo_msgs/srv/GetEntityState", "/gazebo/get_entity_state", _NODE)
def _get_entity_state(twin: Twin, request: Any) -> Fields:
    try:
        pose, twist = entities.state_fields(twin, request.name, request.reference_frame)
    except TwinError as error:
        return refused("get_entity_state", error, "success")
    state = {"name": request.name, "pose": pose, "twist": twist, "reference_frame": request.reference_frame}
    return {"header": header(twin.time, request.reference_frame or "world"), "state": state, "success": True}


@twin_service("gazebo_msgs/srv/SetEntityState", "/set_entity_state", _NODE)
@twin_service("gazebo_msgs/srv/SetEntityState", "/gazebo/set_entity_state", _NODE)
def _set_entity_state(twin: Twin, request: Any) -> Fields:
    state = request.state
    given = {"pose": state.pose, "twist": state.twist, "reference": state.reference_frame}
    return tried("set_entity_state", lambda: entities.set_state(twin, state.name, **given))


@twin_service("std_srvs/srv/Empty", "/pause_physics", _NODE)
def _pause(twin: Twin, request: Any) -> Fields:
    twin.pause()
    return {}


@twin_service("std_srvs/srv/Empty", "/unpause_physics", _NODE, between_advances=True)
def _unpause(twin: Twin, request: Any) -> Fields:
    return tried("unpause_physics", lambda: play(twin), field="")


@twin_service("std_srvs/srv/Empty", "/reset_simulation", _NODE, between_advances=True)
def _reset(twin: Twin, request: Any) -> Fields:
    reset(twin)
    return {}
