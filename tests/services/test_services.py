"""The services of a running twin, called with requests as they are decoded."""

from types import SimpleNamespace as Message

import pytest
from conftest import ROVER, rovers

from drake_twin.services import parameters, services_of

RESULT = {"result": 1, "error_message": ""}
BOX = """<robot name="box"><link name="base_link">
  <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
</link></robot>"""


def pose(x=0.0, y=0.0, z=0.0, w=1.0):
    return Message(position=Message(x=x, y=y, z=z), orientation=Message(x=0.0, y=0.0, z=0.0, w=w))


def answer(twin, name, /, **request):
    """The fields of a service's response, once it is there."""
    (service,) = (item for item in services_of(twin) if item.name == name)
    response = service.answer(Message(**request))
    if not hasattr(response, "send"):
        return response
    while True:
        try:
            next(response)
        except StopIteration as end:
            return end.value


@pytest.fixture
def twin():
    with rovers(2).build() as twin:
        yield twin


def test_nine_services_of_each_controller_manager(twin):
    found = {
        service.name: service.type for service in services_of(twin) if service.node.endswith("/controller_manager")
    }
    own = {name: kind for name, kind in found.items() if not kind.startswith("rcl_interfaces/")}
    expected = {
        "list_controllers": "ListControllers",
        "list_controller_types": "ListControllerTypes",
        "list_hardware_interfaces": "ListHardwareInterfaces",
        "list_hardware_components": "ListHardwareComponents",
        "load_controller": "LoadController",
        "configure_controller": "ConfigureController",
        "unload_controller": "UnloadController",
        "switch_controller": "SwitchController",
        "reload_controller_libraries": "ReloadControllerLibraries",
    }
    assert own == {
        f"/{robot}/controller_manager/{name}": f"controller_manager_msgs/srv/{kind}"
        for robot in ("robot_1", "robot_2")
        for name, kind in expected.items()
    }


def test_controllers_are_listed_switched_and_listed(twin):
    manager = "/robot_1/controller_manager"
    before = answer(twin, f"{manager}/list_controllers")["controller"]
    states = {item["name"]: item["state"] for item in before}
    assert states == {"joint_state_broadcaster": "active", "forward_velocity_controller": "active"}
    claimed = next(item for item in before if item["name"] == "forward_velocity_controller")["claimed_interfaces"]
    assert len(claimed) == 4
    switch = {"activate_controllers": [], "deactivate_controllers": ["forward_velocity_controller"], "strictness": 2}
    assert answer(twin, f"{manager}/switch_controller", **switch) == {"ok": True, "message": ""}
    after = answer(twin, f"{manager}/list_controllers")["controller"]
    assert {item["name"]: item["state"] for item in after} == states | {"forward_velocity_controller": "inactive"}
    name = {"name": "forward_velocity_controller"}
    assert answer(twin, f"{manager}/unload_controller", **name) == {"ok": True}
    assert answer(twin, f"{manager}/load_controller", **name) == {"ok": True}
    assert answer(twin, f"{manager}/configure_controller", **name) == {"ok": True}
    assert answer(twin, f"{manager}/reload_controller_libraries", force_kill=True) == {"ok": True}


def test_a_refused_load_is_logged_with_its_reason_once(twin, caplog):
    for _ in range(3):
        assert answer(twin, "/robot_2/controller_manager/load_controller", name="nobody") == {"ok": False}
    (record,) = caplog.records
    assert record.getMessage() == (
        "robot_2: controller_manager: the parameters files have no controller 'nobody';"
        " they have joint_state_broadcaster, forward_velocity_controller"
    )


def test_hardware(twin):
    interfaces = answer(twin, "/robot_1/controller_manager/list_hardware_interfaces")
    assert all(item["data_type"] == "double" for kind in interfaces.values() for item in kind)
    assert [item["is_claimed"] for item in interfaces["command_interfaces"]] == [True] * 4
    (component,) = answer(twin, "/robot_1/controller_manager/list_hardware_components")["component"]
    assert component["state"] == {"id": 3, "label": "active"}
    assert component["command_interfaces"] == interfaces["command_interfaces"]
    assert answer(twin, "/robot_1/controller_manager/list_controller_types")["types"]


# Parameters ----------------------------------------------------------------------------------------------------------


def test_parameters_of_the_state_publisher(twin):
    values = answer(
        twin, "/robot_1/robot_state_publisher/get_parameters", names=["robot_description", "use_sim_time", "other"]
    )["values"]
    assert values == [
        {"type": 4, "string_value": twin.built.plans[0].description.text},
        {"type": 1, "bool_value": True},
        {"type": 0},
    ]


def test_parameters_of_a_controller(twin):
    node = "/robot_1/forward_velocity_controller"
    listed = answer(twin, f"{node}/list_parameters", prefixes=[], depth=0)["result"]
    assert set(listed["names"]) >= {"use_sim_time", "joints", "interface_name"}
    values = answer(twin, f"{node}/get_parameters", names=["joints", "interface_name"])["values"]
    assert values[0]["type"] == 9
    assert len(values[0]["string_array_value"]) == 4
    assert values[1] == {"type": 4, "string_value": "velocity"}
    assert answer(twin, f"{node}/get_parameter_types", names=["joints", "x"]) == {"types": [9, 0]}
    described = answer(twin, f"{node}/describe_parameters", names=["joints", "x"])["descriptors"]
    assert (described[0]["name"], described[0]["type"], described[0]["read_only"]) == ("joints", 9, False)
    assert described[0]["description"] == "The joints, in the order of a command's elements"
    assert described[1] == {"name": "x", "type": 0}


@pytest.mark.parametrize(
    ("prefixes", "depth", "names", "found"),
    [  # as rclcpp's NodeParameters::list_parameters: the depth counts what is below the prefix, with a dot between
        ([], 0, ["use_sim_time", "gains.j.p", "gains.j.i", "gains2", "gains"], ["gains.j"]),
        ([], 1, ["use_sim_time", "gains2", "gains"], []),
        (["gains"], 0, ["gains.j.p", "gains.j.i", "gains"], ["gains.j"]),
        (["gains"], 1, ["gains"], []),
        (["gains.j"], 1, ["gains.j.p", "gains.j.i"], ["gains.j"]),
        (["other"], 0, [], []),
    ],
)
def test_parameters_are_listed_below_prefixes(prefixes, depth, names, found):
    known = parameters.constant_node("/n", {"gains.j.p": 1.0, "gains.j.i": 2.0, "gains2": 3, "gains": 4})
    listed = parameters._list_parameters(known, Message(prefixes=prefixes, depth=depth))["result"]
    assert listed == {"names": names, "prefixes": found}


@pytest.mark.parametrize(
    ("value", "kind", "field"),
    [  # rcl_interfaces/msg/ParameterType and ParameterValue
        (True, 1, "bool_value"),
        (3, 2, "integer_value"),
        (0.5, 3, "double_value"),
        ("text", 4, "string_value"),
        ([True, False], 6, "bool_array_value"),
        ([1, 2], 7, "integer_array_value"),
        ([1.0, 2.0], 8, "double_array_value"),
        ([1, 2.5], 8, "double_array_value"),
        (["a"], 9, "string_array_value"),
        ([], 0, None),
        ([1, "a"], 0, None),
        ({"a": 1}, 0, None),
        (None, 0, None),
    ],
)
def test_values_have_the_types_of_ros(value, kind, field):
    expected = {"type": kind} if field is None else {"type": kind, field: value}
    asked = Message(names=["it"])
    node, other = (parameters.constant_node("/n", {name: value}) for name in ("it", "other"))
    assert parameters._get_parameters(node, asked) == {"values": [expected]}
    assert parameters._get_parameter_types(node, asked) == {"types": [kind]}
    if field is not None:
        same = Message(parameters=[Message(name="it", value=Message(type=kind, **{field: value}))])
        assert parameters._set_parameters(node, same)["results"] == [{"successful": True, "reason": ""}]
        assert not parameters._set_parameters(other, same)["results"][0]["successful"]


def test_parameters_are_set_only_to_what_they_are(twin):
    def parameter(name, kind, **value):
        return Message(name=name, value=Message(type=kind, **value))

    good, bad = parameter("use_sim_time", 1, bool_value=True), parameter("use_sim_time", 1, bool_value=False)
    node = "/robot_1/robot_state_publisher"
    refused = {
        "successful": False,
        "reason": "parameter 'use_sim_time' cannot be false: the twin has no other time",
    }
    results = answer(twin, f"{node}/set_parameters", parameters=[good, bad])["results"]
    assert results == [{"successful": True, "reason": ""}, refused]
    assert answer(twin, f"{node}/set_parameters_atomically", parameters=[good, bad]) == {"result": refused}
    assert answer(twin, f"{node}/set_parameters_atomically", parameters=[good])["result"]["successful"]


# simulation_interfaces -----------------------------------------------------------------------------------------------


def spawn(twin, name="robot_3", **request):
    default = {
        "name": name,
        "allow_renaming": False,
        "uri": ROVER,
        "resource_string": "",
        "entity_namespace": "",
        "initial_pose": Message(header=Message(frame_id="world"), pose=pose(y=4.0, z=0.13)),
    }
    return answer(twin, "/drake_twin/spawn_entity", **(default | request))


def test_a_filter_that_would_take_hours_is_answered_and_one_that_cannot_be_read_is_refused(twin):
    listed = answer(twin, "/drake_twin/get_entities", filters=filters("^(robot|robot_1|.|..)*$"))
    assert {"robot_1", "robot_2"} <= set(listed["entities"])
    refused = answer(twin, "/drake_twin/get_entities", filters=filters("(?=a)"))
    assert refused["result"]["result"] != RESULT["result"]
    assert "is not a regular expression that a filter can have" in refused["result"]["error_message"]


def filters(text=""):
    return Message(filter=text, categories=[], tags=Message(tags=[]), bounds=Message(type=0))


def test_robots_are_spawned_listed_and_deleted(twin):
    assert spawn(twin) == {"result": RESULT, "entity_name": "robot_3"}
    assert twin.robots == ("robot_1", "robot_2", "robot_3")
    assert twin.entities.state("robot_3").position == (0.0, 4.0, 0.13)
    assert "/robot_3/controller_manager/list_controllers" in {item.name for item in services_of(twin)}
    listed = answer(twin, "/drake_twin/get_entities", filters=filters("_[13]$"))
    assert listed == {"result": RESULT, "entities": ["robot_1", "robot_3"]}
    assert answer(twin, "/drake_twin/delete_entity", entity="robot_3") == {"result": RESULT}
    assert twin.robots == ("robot_1", "robot_2")


def test_a_robot_is_spawned_from_its_text(twin):
    assert spawn(twin, uri="", resource_string=BOX)["result"] == RESULT
    assert twin.built.plans[2].description.links == ("base_link",)


def test_a_text_is_not_expanded_for_expressions_are_code(twin):
    text = BOX.replace("base_link", "${1 + 1}").replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    assert spawn(twin, uri="", resource_string=text)["result"] == RESULT
    assert twin.built.plans[2].description.links == ("${1 + 1}",)


@pytest.mark.parametrize(
    ("request_", "code", "words"),
    [
        ({"name": "robot_1"}, 101, "Entity [robot_1] already exists."),
        ({"name": "a/b"}, 102, "'a/b' is not a name: use letters from A to Z, digits, '_' and '-', 100 at most"),
        ({"uri": ""}, 104, "neither uri nor resource_string is given"),
        ({"entity_namespace": "a b"}, 105, "'a b' is not a namespace"),
        ({"entity_namespace": 60 * "a" + "!"}, 105, "is not a namespace"),  # at once, and not after an hour
        ({"uri": "", "resource_string": "<robot"}, 106, "robot_3.urdf"),
        ({"initial_pose": Message(header=Message(frame_id="moon"), pose=pose())}, 109, "not in 'moon'"),
        ({"initial_pose": Message(header=Message(frame_id=""), pose=pose(x=float("nan")))}, 109, "is not finite"),
    ],
)
def test_spawns_that_are_refused(twin, request_, code, words):
    result = spawn(twin, **request_)["result"]
    assert (result["result"], words in result["error_message"]) == (code, True), result
    assert twin.robots == ("robot_1", "robot_2")


def test_a_taken_name_gets_a_number(twin):
    assert spawn(twin, "robot_1", allow_renaming=True)["entity_name"] == "robot_1_1"


def test_states_of_entities(twin):
    moved = Message(header=Message(frame_id=""), pose=pose(1.0, 2.0, 3.0), twist=None)
    request = {"entity": "robot_1", "state": moved, "set_pose": True, "set_twist": False, "set_acceleration": False}
    assert answer(twin, "/drake_twin/set_entity_state", **request) == {"result": RESULT}
    state = answer(twin, "/drake_twin/get_entity_state", entity="robot_1")["state"]
    assert state["pose"]["position"] == {"x": 1.0, "y": 2.0, "z": 3.0}
    both = answer(twin, "/drake_twin/get_entities_states", filters=filters())
    assert both["entities"] == ["robot_1", "robot_2"]
    assert both["states"][0] == state
    unknown = answer(twin, "/drake_twin/get_entity_state", entity="nobody")["result"]
    assert unknown["result"] == 2
    assert unknown["error_message"].startswith("Entity [nobody] does not exist.")


def test_time_is_stepped_only_while_paused(twin):
    refused = answer(twin, "/drake_twin/step_simulation", steps=3)["result"]
    assert refused == {"result": 4, "error_message": "time is running: pause the simulation before it is stepped."}
    paused = Message(state=2)
    assert answer(twin, "/drake_twin/get_simulation_state") == {"state": {"state": 1}, "result": RESULT}
    assert answer(twin, "/drake_twin/set_simulation_state", state=paused) == {"result": RESULT}
    assert answer(twin, "/drake_twin/set_simulation_state", state=Message(state=0))["result"]["result"] == 101
    assert answer(twin, "/drake_twin/step_simulation", steps=3) == {"result": RESULT}
    assert twin.clock.step_count == 3
    assert answer(twin, "/drake_twin/get_simulation_state")["state"] == {"state": 2}
    assert answer(twin, "/drake_twin/step_simulation", steps=0)["result"]["result"] == 4


def test_lockstep_refuses_to_play(twin):
    twin.pause()
    twin.frames.lockstep = True
    refused = answer(twin, "/drake_twin/set_simulation_state", state=Message(state=1))["result"]
    assert refused["result"] == 3
    assert refused["error_message"].startswith("the twin runs in lock-step: ")
    assert twin.clock.paused
    assert answer(twin, "/drake_twin/step_simulation", steps=2) == {"result": RESULT}


def test_reset_by_scope(twin):
    spawn(twin)
    twin.advance_to(0.05)
    assert answer(twin, "/drake_twin/reset_simulation", scope=1)["result"]["result"] == 0
    assert twin.time == 0.05
    assert answer(twin, "/drake_twin/reset_simulation", scope=4) == {"result": RESULT}
    assert (twin.robots, twin.time) == (("robot_1", "robot_2"), 0.05)
    spawn(twin)
    assert answer(twin, "/drake_twin/reset_simulation", scope=0) == {"result": RESULT}
    assert (twin.robots, twin.time) == (("robot_1", "robot_2"), 0.0)


def test_the_features_that_the_simulator_has(twin):
    """simulation_interfaces/msg/SimulatorFeatures of 1.0, by the names of its constants."""
    numbers = {
        "SPAWNING": 0,
        "DELETING": 1,
        "SPAWNING_RESOURCE_STRING": 9,
        "SPAWNABLES": 14,
        "ENTITY_STATE_GETTING": 10,
        "ENTITY_STATE_SETTING": 11,
        "SIMULATION_RESET": 20,
        "SIMULATION_RESET_SPAWNED": 23,
        "SIMULATION_STATE_GETTING": 24,
        "SIMULATION_STATE_SETTING": 25,
        "SIMULATION_STATE_PAUSE": 26,
        "STEP_SIMULATION_SINGLE": 31,
        "STEP_SIMULATION_MULTIPLE": 32,
        "STEP_SIMULATION_ACTION": 33,
    }
    features = answer(twin, "/drake_twin/get_simulator_features")["features"]
    assert sorted(features["features"]) == sorted(numbers.values())
    assert features["spawn_formats"] == ["urdf", "sdf", "mjcf", "xacro"]


# Gazebo classic and gz ------------------------------------------------------------------------------------------------


def test_gazebo_classic_takes_a_names_place_from_the_description(twin):
    """gazebo_ros_factory.cpp: without a name it is spawned anyway, and Gazebo appends a number as needed."""
    request = {"name": "", "xml": BOX, "robot_namespace": "", "initial_pose": pose(y=4.0, w=0.0)}
    for _ in range(2):
        response = answer(twin, "/spawn_entity", **request, reference_frame="/map")
        assert response == {"success": True, "status_message": "Successfully sent factory message to Gazebo."}
    assert answer(twin, "/get_model_list")["model_names"] == ["robot_1", "robot_2", "box", "box_1"]
    refused = answer(twin, "/spawn_entity", **request | {"xml": "<robot/>"}, reference_frame="")
    assert refused["status_message"] == ("'' is not a name: use letters from A to Z, digits, '_' and '-', 100 at most.")


def test_gazebo_classic(twin):
    request = {"name": "third", "xml": BOX, "robot_namespace": "", "initial_pose": pose(y=4.0, w=0.0)}
    response = answer(twin, "/spawn_entity", **request, reference_frame="world")
    assert response == {"success": True, "status_message": "SpawnEntity: Successfully spawned entity [third]"}
    again = answer(twin, "/spawn_entity", **request, reference_frame="world")
    assert again == {"success": False, "status_message": "Entity [third] already exists."}
    assert answer(twin, "/get_model_list")["model_names"] == ["robot_1", "robot_2", "third"]
    state = Message(name="third", pose=pose(5.0), twist=Message(linear=pose().position, angular=pose().position))
    state.reference_frame = "robot_2"
    assert answer(twin, "/set_entity_state", state=state) == {"success": True}
    response = answer(twin, "/gazebo/get_entity_state", name="third", reference_frame="robot_2")
    assert (response["success"], response["header"].frame_id) == (True, "robot_2")
    assert not answer(twin, "/gazebo/get_entity_state", name="nobody", reference_frame="")["success"]
    found = response["state"]
    assert found["pose"]["position"] == pytest.approx({"x": 5.0, "y": 0.0, "z": 0.0}, abs=1e-9)
    assert twin.entities.state("third").position == pytest.approx((5.0, 2.0, 0.13))
    assert answer(twin, "/delete_entity", name="third")["success"]
    assert answer(twin, "/pause_physics") == {}
    assert twin.clock.paused
    assert answer(twin, "/unpause_physics") == {}
    assert not twin.clock.paused


def test_gz(twin):
    factory = Message(name="robot_1", allow_renaming=True, sdf="", sdf_filename=ROVER, clone_name="", pose=pose(y=4.0))
    factory.relative_to = "world"
    assert answer(twin, "/world/default/create", entity_factory=factory) == {"success": True}
    entity = Message(id=0, name="robot_1_1", type=2)
    assert answer(twin, "/world/default/set_pose", entity=entity, pose=pose(y=6.0)) == {"success": True}
    assert twin.entities.state("robot_1_1").position == (0.0, 6.0, 0.0)
    assert answer(twin, "/world/default/remove", entity=entity) == {"success": True}
    control = Message(pause=True, step=False, multi_step=5, run_to_sim_time=Message(sec=0, nanosec=0))
    control.reset = Message(all=False, time_only=False, model_only=False)
    assert answer(twin, "/world/default/control", world_control=control) == {"success": True}
    assert (twin.clock.step_count, twin.clock.paused) == (5, True)
    control.reset.all, control.multi_step, control.pause = True, 0, False
    assert answer(twin, "/world/default/control", world_control=control) == {"success": True}
    assert (twin.clock.step_count, twin.clock.paused) == (0, False)
