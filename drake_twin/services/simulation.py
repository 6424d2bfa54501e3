"""The services of ``simulation_interfaces``, below the twin's node."""

from collections.abc import Callable
from typing import Any

from drake_twin.errors import InputError, RunError, TwinError
from drake_twin.messages import header
from drake_twin.scenario.names import problem_of_name, problem_of_namespace
from drake_twin.services import entities
from drake_twin.services.name_filter import NameFilter
from drake_twin.services.registry import SIMULATION_NODE, Fields, Later, twin_service
from drake_twin.services.running import (
    FAILED,
    INCORRECT_STATE,
    NOT_FOUND,
    OK,
    UNSUPPORTED,
    play,
    reset,
    steps,
)
from drake_twin.twin.twin import Twin

# SpawnEntity
_NOT_UNIQUE, _NAME_INVALID, _UNSUPPORTED_FORMAT, _NO_RESOURCE, _NAMESPACE_INVALID, _PARSE_ERROR = range(101, 107)
_INVALID_POSE = 109
_ALREADY = 101  # SetSimulationState
_STOPPED, _PLAYING, _PAUSED = range(3)  # simulation_interfaces/msg/SimulationState
# simulation_interfaces/msg/SimulatorFeatures: spawning (from text, too), deleting, getting and setting states of
# entities, resets (of all, of what was spawned), getting and setting the simulation's state, pause, steps
_FEATURES = [0, 1, 9, 10, 11, 14, 20, 23, 24, 25, 26, 31, 32, 33]
_DEFAULT, _TIME, _STATE, _SPAWNED, _ALL = 0, 1, 2, 4, 255  # ResetSimulation


def _named(name: str) -> str:
    return f"{SIMULATION_NODE}/{name}"


def _srv(name: str) -> str:
    return f"simulation_interfaces/srv/{name}"


def result(code: int = OK, error: object = "") -> Fields:
    """Return the fields of a ``simulation_interfaces/msg/Result``."""
    return {"result": code, "error_message": str(error)}


def _tried(do: Callable[[], Fields | None], code: int = FAILED) -> Fields:
    """Return a response with the result, and with the fields that a function returns."""
    try:
        return {"result": result(), **(do() or {})}
    except TwinError as error:
        return {"result": result(code, error)}


@twin_service(_srv("GetSimulatorFeatures"), _named("get_simulator_features"))
def _features(twin: Twin, request: Any) -> Fields:
    formats = ["urdf", "sdf", "mjcf", "xacro"]
    return {"features": {"features": _FEATURES, "spawn_formats": formats, "custom_info": "drake_twin"}}


# Entities ------------------------------------------------------------------------------------------------------------


@twin_service(_srv("SpawnEntity"), _named("spawn_entity"), between_advances=True)
def _spawn(twin: Twin, request: Any) -> Fields:
    pose, name = request.initial_pose, request.name
    if name in entities.entity_names(twin):
        if not request.allow_renaming:
            return {"result": result(_NOT_UNIQUE, f"Entity [{name}] already exists.")}
        name = entities.free_name(twin, name)
    if (what := problem_of_name(name)) is not None:
        return {"result": result(_NAME_INVALID, what)}
    if not request.uri and not request.resource_string:
        return {"result": result(_NO_RESOURCE, "neither uri nor resource_string is given")}
    source = {"uri": request.uri} if request.uri else {"text": request.resource_string}
    space = request.entity_namespace
    if (what := problem_of_namespace(space)) is not None:
        return {"result": result(_NAMESPACE_INVALID, what)}
    try:
        entities.spawn(twin, name, **source, namespace=space, pose=pose.pose, frame=pose.header.frame_id)
    except entities.PoseError as error:
        return {"result": result(_INVALID_POSE, error)}
    except TwinError as error:
        return {"result": result(_PARSE_ERROR, error)}
    return {"result": result(), "entity_name": name}


@twin_service(_srv("DeleteEntity"), _named("delete_entity"), between_advances=True)
def _delete(twin: Twin, request: Any) -> Fields:
    known = request.entity in entities.entity_names(twin)
    return _tried(lambda: twin.entities.delete(request.entity), FAILED if known else NOT_FOUND)


@twin_service(_srv("GetEntities"), _named("get_entities"))
def _get_entities(twin: Twin, request: Any) -> Fields:
    return _tried(lambda: {"entities": _filtered(twin, request.filters)})


@twin_service(_srv("GetEntitiesStates"), _named("get_entities_states"))
def _get_entities_states(twin: Twin, request: Any) -> Fields:
    def states() -> Fields:
        names = _filtered(twin, request.filters)
        return {"entities": names, "states": [_state(twin, name) for name in names]}

    return _tried(states)


@twin_service(_srv("GetEntityState"), _named("get_entity_state"))
def _get_entity_state(twin: Twin, request: Any) -> Fields:
    return _tried(lambda: {"state": _state(twin, request.entity)}, NOT_FOUND)


@twin_service(_srv("SetEntityState"), _named("set_entity_state"))
def _set_entity_state(twin: Twin, request: Any) -> Fields:
    state = request.state
    pose, twist = state.pose if request.set_pose else None, state.twist if request.set_twist else None
    if request.set_acceleration:
        return {"result": result(UNSUPPORTED, "an entity's acceleration follows from its forces")}
    try:
        twin.entities.state(request.entity)
    except InputError as error:
        return {"result": result(NOT_FOUND, error)}
    set_state = entities.set_state
    return _tried(lambda: set_state(twin, request.entity, pose=pose, twist=twist, reference=state.header.frame_id))


def _state(twin: Twin, entity: str) -> Fields:
    pose, twist = entities.state_fields(twin, entity)
    return {"header": header(twin.time, "world"), "pose": pose, "twist": twist}


def _filtered(twin: Twin, filters: Any) -> list[str]:
    """Return the names of the entities that a filter accepts.

    Raises:
        InputError: If it filters by something that the twin's entities do not have.
    """
    if len(filters.categories) or len(filters.tags.tags) or filters.bounds.type:
        raise InputError("the twin's entities have no categories, tags and bounds: filter them by their names")
    names = NameFilter(filters.filter)
    return [name for name in entities.entity_names(twin) if names.accepts(name)]


@twin_service(_srv("GetSpawnables"), _named("get_spawnables"))
def _get_spawnables(twin: Twin, request: Any) -> Fields:
    models = dict.fromkeys(robot.model for robot in twin.scenario.robots)
    return {"result": result(), "spawnables": [{"uri": model} for model in models]}


# Time ----------------------------------------------------------------------------------------------------------------


@twin_service(_srv("ResetSimulation"), _named("reset_simulation"), between_advances=True)
def _reset(twin: Twin, request: Any) -> Fields:
    scope = request.scope or _ALL
    if scope not in (_TIME | _STATE, _SPAWNED, _TIME | _STATE | _SPAWNED, _ALL):
        return {"result": result(UNSUPPORTED, "time and state can only be reset together")}

    def do() -> None:
        if scope & _SPAWNED:
            for robot in set(twin.robots) - set(twin.entities.first_robots):
                twin.entities.delete(robot)
        if scope & _TIME:
            reset(twin)

    return _tried(do)


@twin_service(_srv("GetSimulationState"), _named("get_simulation_state"))
def _get_simulation_state(twin: Twin, request: Any) -> Fields:
    return {"state": {"state": _present_state(twin)}, "result": result()}


@twin_service(_srv("SetSimulationState"), _named("set_simulation_state"), between_advances=True)
def _set_simulation_state(twin: Twin, request: Any) -> Fields:
    wanted = request.state.state
    if wanted not in (_STOPPED, _PLAYING, _PAUSED):
        return {"result": result(UNSUPPORTED, "valid are STATE_STOPPED, STATE_PLAYING and STATE_PAUSED")}
    if wanted == _present_state(twin):
        return {"result": result(_ALREADY, "the simulation is in this state already")}
    if wanted == _PLAYING:
        return _tried(lambda: play(twin), INCORRECT_STATE)
    twin.pause()
    return _tried((lambda: reset(twin)) if wanted == _STOPPED else lambda: None)


def _present_state(twin: Twin) -> int:
    if not twin.clock.paused:
        return _PLAYING
    return _PAUSED if twin.clock.step_count else _STOPPED


@twin_service(_srv("StepSimulation"), _named("step_simulation"), between_advances=True)
def _step_simulation(twin: Twin, request: Any) -> Later:
    try:
        yield from steps(twin, request.steps)
    except (InputError, RunError) as error:
        return {"result": result(FAILED, error)}
    return {"result": result()}
