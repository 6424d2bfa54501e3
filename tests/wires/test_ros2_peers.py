"""A running twin on the graph, against clients that nobody here wrote: zenoh-ros2-sdk, and Zenoh's own late joiner."""

import threading
from itertools import pairwise

import pytest
from conftest import ARM, ROVER, rovers
from wires.ros_client import ros_client, while_running
from wires.zenoh_peer import Heard, free_port, peer, tokens

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.messages import message
from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.services.graph import connect
from drake_twin.twin.replay import replay
from drake_twin.wires.rmw_zenoh_format import attachment, topic_key
from drake_twin.wires.zenoh_wire import ZenohWire

zenoh = pytest.importorskip("zenoh")
ext = pytest.importorskip("zenoh.ext")
pytest.importorskip("zenoh_ros2_sdk", reason="zenoh-ros2-sdk, an independent ROS 2 client, is not installed")


DOMAIN = 5
COMMANDS = "/robot_1/forward_velocity_controller/commands"
LIST = "/robot_1/controller_manager/list_controllers"
ARRAY = "std_msgs/msg/Float64MultiArray"


@pytest.fixture
def port():
    return free_port()


def connected(twin, port):
    return connect(twin, [ZenohWire(domain=DOMAIN, port=port)])


@pytest.fixture
def twin(port):
    with rovers(2).build() as twin:
        seam = connected(twin, port)
        try:
            yield twin
        finally:
            seam.close()


@pytest.fixture
def client(twin, port):
    with ros_client(port, DOMAIN) as client:
        yield client


def stamp(header):
    return header.stamp.sec * 1_000_000_000 + header.stamp.nanosec


def array(*values):
    return vars(message(ARRAY, values))


def spawn_request(name, y):
    pose = message("geometry_msgs/msg/PoseStamped", {"pose": {"position": {"y": y, "z": 0.13}}})
    return {
        "name": name,
        "allow_renaming": False,
        "uri": ROVER,
        "resource_string": "",
        "entity_namespace": "",
        "initial_pose": pose,
    }


def test_joint_states_without_a_gap(twin, client):
    """The first message is of the moment at which the subscriber is noticed, the others are on the grid of 100 Hz."""
    heard = Heard()
    client.subscribe("/robot_1/joint_states", "sensor_msgs/msg/JointState", heard)
    while_running(twin, lambda: heard.wait_for(250, timeout=60))
    stamps = [stamp(item.header) for item in heard.items]
    assert len(stamps) >= 200
    assert {after - before for before, after in pairwise(stamps[1:])} == {10_000_000}
    assert heard.items[0].name == twin.joint_states("robot_1").name


def test_the_clock_ticks_with_each_physics_step(twin, client):
    heard = Heard()
    client.subscribe("/clock", "rosgraph_msgs/msg/Clock", heard)
    while_running(twin, lambda: heard.wait_for(50))
    times = [item.clock.sec * 1_000_000_000 + item.clock.nanosec for item in heard.items]
    assert {after - before for before, after in pairwise(times[1:])} == {1_000_000}


def test_500_of_500_commands_are_applied_and_replayed(twin, client):
    publisher = client.publisher(COMMANDS, ARRAY)
    lists = client.service(
        "/robot_1/controller_manager/list_controllers", "controller_manager_msgs/srv/ListControllers"
    )

    def command():
        for number in range(500):
            publisher.publish(**array(*[number / 100] * 4))
        return lists.call(structure_needs_at_least_one_member=0)

    twin.recorder.begin()
    assert while_running(twin, command) is not None
    twin.advance_to(twin.time + 0.5)
    calls = [call for call in twin.recorder.recording().calls if call.name == "publish"]
    assert [float(call.arguments[1].data[0]) if call.arguments else call.named["data"].data[0] for call in calls] == [
        number / 100 for number in range(500)
    ]
    assert list(twin.graph.command(COMMANDS).data) == [4.99] * 4
    with replay(twin.recorder.recording()) as again:
        assert again.state_sha256() == twin.state_sha256()


def test_services_answer_while_the_twin_runs_and_while_it_is_paused(twin, client):
    lists = client.service(
        "/robot_1/controller_manager/list_controllers", "controller_manager_msgs/srv/ListControllers"
    )
    switch = client.service(
        "/robot_1/controller_manager/switch_controller", "controller_manager_msgs/srv/SwitchController"
    )
    state = client.service("/drake_twin/set_simulation_state", "simulation_interfaces/srv/SetSimulationState")

    def states():
        return {item.name: item.state for item in lists.call(structure_needs_at_least_one_member=0).controller}

    def use():
        running = states()
        paused = message("simulation_interfaces/msg/SimulationState", {"state": 2})
        assert state.call(state=paused).result.result == 1
        request = message("controller_manager_msgs/srv/SwitchController_Request", {"strictness": 2})
        request.deactivate_controllers = ["forward_velocity_controller"]
        fields = {name: value for name, value in vars(request).items() if name != "__msgtype__"}
        assert switch.call(**fields).ok
        return running, states()

    running, paused = while_running(twin, use)
    assert running == {"joint_state_broadcaster": "active", "forward_velocity_controller": "active"}
    assert paused == {"joint_state_broadcaster": "active", "forward_velocity_controller": "inactive"}
    assert twin.clock.paused


def test_robot_description_as_a_parameter(twin, client):
    get = client.service("/robot_1/robot_state_publisher/get_parameters", "rcl_interfaces/srv/GetParameters")
    values = while_running(twin, lambda: get.call(names=["robot_description", "use_sim_time"])).values
    assert values[0].string_value == twin.built.plans[0].description.text
    assert values[1].bool_value is True


def test_topics_on_the_graph(twin, client):
    topics = while_running(twin, client.topics)
    expected = {name: [kind] for name, kind in twin.graph.topics().items()}
    assert {name: topics.get(name) for name in expected} == expected
    hidden = {name for name in topics if "/_action/" in name}
    assert topics.keys() - expected.keys() == hidden


def test_a_late_joiner_gets_the_description_and_the_fixed_frames(twin, port):
    twin.advance_to(0.1)
    with peer(port) as other:
        for topic, kind in (
            ("/robot_1/robot_description", "std_msgs/msg/String"),
            ("/tf_static", "tf2_msgs/msg/TFMessage"),
        ):
            heard = Heard()
            key, history = topic_key(DOMAIN, topic, kind, type_hash(kind)), ext.HistoryConfig(max_samples=1)
            subscriber = ext.declare_advanced_subscriber(other, key, heard, history=history)
            while_running(twin, lambda heard=heard: heard.wait_for(1))
            subscriber.undeclare()
            assert heard.items[0].payload.to_bytes() == serialize(twin.latest(topic))


def test_a_spawn_brings_topics_and_a_delete_takes_them(twin, client):
    spawn = client.service("/drake_twin/spawn_entity", "simulation_interfaces/srv/SpawnEntity")
    delete = client.service("/drake_twin/delete_entity", "simulation_interfaces/srv/DeleteEntity")
    heard = Heard()

    def use():
        before = client.topics()
        assert spawn.call(**spawn_request("robot_3", 4.0)).result.result == 1
        with_three = client.topics()
        subscriber = client.subscribe("/robot_3/joint_states", "sensor_msgs/msg/JointState", heard)
        heard.wait_for(5)
        subscriber.close()
        assert delete.call(entity="robot_3").result.result == 1
        return before, with_three, client.topics()

    before, with_three, after = while_running(twin, use)
    assert {name for name in with_three if name not in before} >= {
        "/robot_3/joint_states",
        "/robot_3/robot_description",
        "/robot_3/forward_velocity_controller/commands",
    }
    assert after == before


def test_fifty_spawns_and_deletes_leave_no_token_and_no_thread(twin, client, port):
    spawn = client.service("/drake_twin/spawn_entity", "simulation_interfaces/srv/SpawnEntity")
    delete = client.service("/drake_twin/delete_entity", "simulation_interfaces/srv/DeleteEntity")

    def use():
        for _ in range(50):
            assert spawn.call(**spawn_request("robot_3", 4.0)).result.result == 1
            assert delete.call(entity="robot_3").result.result == 1
        return client.topics()

    with peer(port) as other:
        before, threads = tokens(other), threading.active_count()
        while_running(twin, use)
        assert of_twin(tokens(other)) == of_twin(before)
        assert threading.active_count() <= threads + 4  # Zenoh's own threads, which Python knows once they have called


def of_twin(of_tokens):
    """The twin's tokens without the numbers within their session, which are new with each endpoint."""
    parts = [text.split("/") for text in of_tokens]
    twins = next(items[2] for items in parts if items[-1] == "drake_twin")
    return sorted("/".join(items[5:]) for items in parts if items[2] == twins)


def test_nodes_of_each_robot_come_and_go_with_their_controllers(twin, port):
    def graph():
        with peer(port) as other:
            return tokens(other)

    own = ("robot_state_publisher", "controller_manager", "joint_state_broadcaster", "forward_velocity_controller")
    simulators = {("%", "drake_twin"), ("%", "gazebo"), ("%", "robot_state_publisher")}
    nodes = {tuple(text.split("/")[7:9]) for text in graph() if "/NN/" in text}
    assert nodes == simulators | {(f"%{robot}", name) for robot in ("robot_1", "robot_2") for name in own}
    manager, parameters = twin.control.manager("robot_1"), "/%robot_1%joint_state_broadcaster%get_parameters/"
    assert parameters in str(graph())
    manager.switch_controller(deactivate=["joint_state_broadcaster"])
    manager.unload_controller("joint_state_broadcaster")
    twin.advance_to(0.01)
    assert parameters not in str(graph())
    manager.load_controller("joint_state_broadcaster")
    twin.advance_to(0.02)
    assert parameters in str(graph())


def test_topics_are_on_the_graph_as_they_are_remapped(port):
    builder = TwinBuilder().robot(
        "rover",
        ROVER,
        xyz=(0, 0, 0.13),
        namespace="hall/left",
        remappings={"/hall/left/joint_states": "/joints", f"/hall/left/{COMMANDS[9:]}": "/drive"},
    )
    with builder.build() as twin:
        seam = connected(twin, port)
        try:
            with ros_client(port, DOMAIN) as client:
                topics = client.topics()
        finally:
            seam.close()
    assert topics["/joints"] == ["sensor_msgs/msg/JointState"]
    assert topics["/drive"] == [ARRAY]
    assert topics["/hall/left/robot_description"] == ["std_msgs/msg/String"]
    assert not {"/hall/left/joint_states", "/hall/left/forward_velocity_controller/commands"} & topics.keys()


def test_what_python_is_refused_is_refused_with_the_same_words(twin, client, caplog):
    publisher = client.publisher(COMMANDS, ARRAY)
    lists = client.service(
        "/robot_1/controller_manager/list_controllers", "controller_manager_msgs/srv/ListControllers"
    )

    def command():
        for _ in range(3):
            publisher.publish(**array(1.0, float("nan"), 1.0, 1.0))
        lists.call(structure_needs_at_least_one_member=0)

    while_running(twin, command)
    with pytest.raises(Exception, match="nan") as refused:
        twin.publish(COMMANDS, [1.0, float("nan"), 1.0, 1.0])
    said = [record.getMessage() for record in caplog.records if "nan" in record.getMessage()]
    assert len(said) == 1
    assert str(refused.value).rstrip(".") in said[0]


POSITIONS = {"command_interfaces": ["position"], "state_interfaces": ["position"]}
ACTIONS = {
    "/arm/c/follow_joint_trajectory": (
        ("joint_trajectory_controller/JointTrajectoryController", {"joints": ["joint_1"], **POSITIONS}),
        "control_msgs/action/FollowJointTrajectory",
        {"trajectory": {"joint_names": ["joint_1"], "points": [{"positions": [0.3], "time_from_start": 0.3}]}},
        0,
    ),
    "/arm/c/gripper_cmd": (
        ("position_controllers/GripperActionController", {"joint": "joint_4"}),
        "control_msgs/action/GripperCommand",
        {"command": {"position": -0.3, "max_effort": 0.0}},
        3,
    ),
}


@pytest.mark.parametrize("action", ACTIONS)
def test_actions_as_an_action_client_sends_them(port, action):
    """zenoh-ros2-sdk has no actions: what rclpy's client does is done by hand."""
    controller, kind, goal, joint = ACTIONS[action]
    builder = TwinBuilder().robot("arm", ARM, active_controllers=())
    with builder.controller("arm", "c", *controller).build() as twin:
        seam = connected(twin, port)
        try:
            with peer(port) as other:
                response, statuses, feedback = while_running(twin, lambda: follow(other, action, kind, goal))
        finally:
            seam.close()
        wanted = 0.3 if joint == 0 else -0.3
        assert response.status == 4
        assert twin.robot_state("arm").positions[joint] == pytest.approx(wanted, abs=0.02)
    assert [item.status_list[0].status for item in statuses][-1] == 4
    assert len(feedback) >= 3


def call(session, service, kind, **fields):
    """Calls a service as rmw_zenoh's clients do."""
    request = serialize(make(f"{kind}_Request", fields))
    key = topic_key(DOMAIN, service, kind, type_hash(kind))
    (reply,) = session.get(key, payload=request, attachment=attachment(1, 1, bytes(16)), timeout=60.0)
    return deserialize(f"{kind}_Response", reply.ok.payload.to_bytes())


def follow(session, action, kind, goal):
    """Sends a goal and waits for its end; returns the response, the statuses and the feedback."""
    heard = {}
    for name, of_topic in (("status", "action_msgs/msg/GoalStatusArray"), ("feedback", f"{kind}_FeedbackMessage")):
        key, heard[name] = topic_key(DOMAIN, f"{action}/_action/{name}", of_topic, type_hash(of_topic)), Heard()
        session.declare_subscriber(
            key,
            lambda sample, heard=heard[name], kind=of_topic: heard(deserialize(kind, sample.payload.to_bytes())),
        )
    uuid = {"uuid": list(range(16))}
    assert call(session, f"{action}/_action/send_goal", f"{kind}_SendGoal", goal_id=uuid, goal=goal).accepted
    response = call(session, f"{action}/_action/get_result", f"{kind}_GetResult", goal_id=uuid)
    heard["status"].wait_for(lambda items: items[-1].status_list[0].status == 4)
    return response, heard["status"].items, heard["feedback"].items
