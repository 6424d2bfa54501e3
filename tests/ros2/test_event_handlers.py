import pytest
from launch_files import launch_python

from drake_twin.errors import InputError

CHAIN = """
create = Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"])
jsb = Node(package="controller_manager", executable="spawner", arguments=["joint_state_broadcaster"])
velocity = Node(package="controller_manager", executable="spawner", arguments=["velocity"])
publisher = Node(package="robot_state_publisher", executable="robot_state_publisher")
"""


def started(launched):
    return [(process.arguments or process.executable, process.start_time) for process in launched.processes]


def test_a_chain_of_exits_ends_with_every_controller_at_time_zero(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnProcessExit(target_action=jsb, on_exit=[velocity])),
        RegisterEventHandler(event_handler=OnProcessExit(target_action=create, on_exit=[jsb])),
        publisher, create,""",
        CHAIN,
    )
    assert started(launched) == [
        ("robot_state_publisher", 0.0),
        (("-topic", "robot_description"), 0.0),
        (("joint_state_broadcaster",), 0.0),
        (("velocity",), 0.0),
    ]
    assert launched.unfired_handlers == ()


def test_a_handler_of_something_that_keeps_running_never_fires_and_is_named(tmp_path):
    launched = launch_python(
        tmp_path,
        "RegisterEventHandler(OnProcessExit(target_action=publisher, on_exit=[jsb, velocity])), publisher",
        CHAIN,
    )
    assert len(launched.processes) == 1
    (handler,) = launched.unfired_handlers
    assert handler.what == "OnProcessExit of robot_state_publisher/robot_state_publisher"
    assert handler.actions == 2
    assert handler.place.line == 22


def test_a_process_that_is_started_fires_what_waits_for_its_start(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnProcessStart(target_action=publisher, on_start=[LogInfo(msg="started"),
            TimerAction(period=3.0, actions=[create])])), publisher,""",
        CHAIN,
    )
    assert launched.log == ("started",)
    assert launched.processes[1].start_time == 3.0


def test_ros2_control_commands_end(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnProcessExit(target_action=load, on_exit=[velocity])),
        RegisterEventHandler(OnProcessExit(target_action=create, on_exit=load)), create,""",
        CHAIN + "load = ExecuteProcess(cmd=['ros2', 'control', 'load_controller', '--set-state', 'active', 'jsb'])",
    )
    assert [process.executable for process in launched.processes] == ["create", "ros2", "spawner"]


def test_a_handler_may_be_a_function_of_the_event(tmp_path):
    before = CHAIN + "def after(event, context):\n    assert event.returncode == 0 and event.action is create\n"
    before += "    return [LogInfo(msg=event.process_name), velocity]\n"
    launched = launch_python(
        tmp_path, "RegisterEventHandler(OnProcessExit(target_action=create, on_exit=after)), create", before
    )
    assert launched.log == ("create",)
    assert len(launched.processes) == 2


def test_a_handler_without_a_target_hears_of_every_process(tmp_path):
    launched = launch_python(
        tmp_path, "RegisterEventHandler(OnProcessExit(on_exit=[LogInfo(msg='end')])), create, publisher, jsb", CHAIN
    )
    assert launched.log == ("end", "end")


def test_a_target_may_be_a_function(tmp_path):
    entities = "RegisterEventHandler(OnProcessExit(target_action=lambda a: a is jsb, on_exit=[LogInfo(msg='end')])),"
    assert launch_python(tmp_path, entities + "create, jsb", CHAIN).log == ("end",)


def test_on_exit_of_the_action_itself(tmp_path):
    launched = launch_python(
        tmp_path,
        "Node(package='ros_gz_sim', executable='create', on_exit=[jsb]),"
        "Node(package='rviz2', executable='rviz2', on_exit=Shutdown())",
        CHAIN,
    )
    assert [process.executable for process in launched.processes] == ["create", "rviz2", "spawner"]
    assert launched.shutdown is None


def test_in_a_loop_over_robots_each_handler_sees_its_own(tmp_path):
    """ROS shows every handler the last robot (launch#501); a deliberate difference."""
    launched = launch_python(
        tmp_path,
        "OpaqueFunction(function=robots)",
        """
def robots(context):
    for name in ("a", "b"):
        create = Node(package="ros_gz_sim", executable="create")
        spawner = Node(package="controller_manager", executable="spawner", arguments=[LaunchConfiguration("robot")])
        yield SetLaunchConfiguration("robot", name)
        yield GroupAction([PushRosNamespace(name), create,
                           RegisterEventHandler(OnProcessExit(target_action=create, on_exit=[spawner]))])
""",
    )
    spawners = [process for process in launched.processes if process.executable == "spawner"]
    assert [(process.namespace, process.arguments) for process in spawners] == [("/a", ("a",)), ("/b", ("b",))]


def test_a_handler_sees_arguments_that_are_declared_after_it(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnProcessExit(target_action=create,
                                           on_exit=[LogInfo(msg=LaunchConfiguration("late"))])),
        create, DeclareLaunchArgument("late", default_value="seen"),""",
        CHAIN,
    )
    assert launched.log == ("seen",)


def test_what_a_handler_includes_is_found_from_the_file_that_registered_it(tmp_path):
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "x.launch.xml").write_text('<launch><log message="$(dirname)"/></launch>')
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnProcessExit(target_action=create, on_exit=[
            IncludeLaunchDescription([ThisLaunchFileDir(), "/below/x.launch.xml"])])), create,""",
        CHAIN,
    )
    assert launched.log == (f"{tmp_path}/below",)


def test_a_handler_may_be_removed_or_serve_once(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(handler), UnregisterEventHandler(handler),
        RegisterEventHandler(OnProcessExit(on_exit=[LogInfo(msg="once")], handle_once=True)), create, jsb,""",
        CHAIN + "handler = OnProcessExit(on_exit=[LogInfo(msg='removed')])",
    )
    assert launched.log == ("once",)


def test_execution_complete_fires_after_the_exit(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(OnExecutionComplete(target_action=create, on_completion=[LogInfo(msg="complete")])),
        RegisterEventHandler(OnProcessExit(target_action=create, on_exit=[LogInfo(msg="exit")])), create,""",
        CHAIN,
    )
    assert launched.log == ("exit", "complete")


def test_a_handler_with_its_own_matcher_visits_its_entities(tmp_path):
    launched = launch_python(
        tmp_path,
        """RegisterEventHandler(EventHandler(matcher=is_exit, entities=[LogInfo(msg="exit")])),
        RegisterEventHandler(Twice(matcher=is_exit, entities=LogInfo(msg="two"))), create,""",
        CHAIN
        + "is_exit = event_named('launch.events.process.ProcessExited')\n"
        + "class Twice(EventHandler):\n    def handle(self, event, context):\n"
        + "        return [LogInfo(msg='one'), super().handle(event, context)]\n",
    )
    assert launched.log == ("one", "two", "exit")


def test_output_is_never_read_so_its_handlers_are_named(tmp_path):
    launched = launch_python(
        tmp_path, "RegisterEventHandler(OnProcessIO(target_action=create, on_stdout=lambda event: None)), create", CHAIN
    )
    assert [handler.what for handler in launched.unfired_handlers] == ["OnProcessIO of ros_gz_sim/create"]


def test_a_shutdown_handler_that_does_not_fire_is_nothing_to_report(tmp_path):
    launched = launch_python(tmp_path, "RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg='end')]))")
    assert launched.unfired_handlers == ()
    assert launched.log == ()


def test_a_lifecycle_nodes_transitions_happen_when_they_are_asked_for(tmp_path):
    launched = launch_python(
        tmp_path,
        """node, RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, goal_state="inactive",
            entities=[EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node),
                                                  transition_id=Transition.TRANSITION_ACTIVATE))])),
        RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, goal_state="active",
            entities=[LogInfo(msg="active")])),
        EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node),
                                    transition_id=Transition.TRANSITION_CONFIGURE)),""",
        """
from launch.events import matches_action
from launch_ros.events.lifecycle import ChangeState
from launch_ros.event_handlers import OnStateTransition
from lifecycle_msgs.msg import Transition
node = LifecycleNode(package="p", executable="e", name="n", namespace="")
""",
    )
    assert launched.log == ("active",)


LIFECYCLE = """
from launch_ros.event_handlers import OnStateTransition
from lifecycle_msgs.msg import Transition
def node(**options):
    return LifecycleNode(package="p", executable="e", name="n", namespace="a", **options)
def on(**options):
    text = " ".join(f"{key}={value}" for key, value in options.items())
    return RegisterEventHandler(OnStateTransition(entities=[LogInfo(msg=text)], **options))
handlers = [on(transition="configure"), on(transition="activate", start_state="activating"), on(transition="cleanup")]
"""


@pytest.mark.parametrize(
    "entities",
    [
        "*handlers, node(), LifecycleTransition(lifecycle_node_names=['/a/n'], transition_ids=[1, '3'])",
        "*handlers, node(autostart=True)",
        "*handlers, node(autostart='true')",
    ],
)
def test_transitions_are_asked_for_in_their_order_and_known_by_their_names(tmp_path, entities):
    launched = launch_python(tmp_path, entities, LIFECYCLE)
    assert launched.log == ("transition=configure", "transition=activate start_state=activating")


def test_transitions_of_other_nodes_and_no_transitions(tmp_path):
    other = "LifecycleTransition(lifecycle_node_names=['/b/n'], transition_ids=[1])"
    assert launch_python(tmp_path, f"*handlers, node(), node(autostart=False), {other}", LIFECYCLE).log == ()
    for empty in ("lifecycle_node_names=[], transition_ids=[1]", "lifecycle_node_names=['/n'], transition_ids=[]"):
        with pytest.raises(InputError, match="provided"):
            launch_python(tmp_path, f"LifecycleTransition({empty})")
    with pytest.raises(InputError, match="'fast' is not a number"):
        launch_python(tmp_path, "LifecycleTransition(lifecycle_node_names=['/n'], transition_ids=['fast'])")


def test_a_process_that_sleeps_ends_in_simulation_time(tmp_path):
    launched = launch_python(
        tmp_path,
        "RegisterEventHandler(OnProcessExit(target_action=sleep, on_exit=[create])), sleep",
        CHAIN + "sleep = ExecuteProcess(cmd=['sleep', '4'])",
    )
    assert launched.processes[1].start_time == 4.0


@pytest.mark.parametrize("executable", ["wait_for_controller_manager", "wait_until_ready.py"])
def test_a_node_that_waits_for_something_ends(tmp_path, executable):
    waiter = f"Node(package='rover_tools', executable={executable!r})"
    launched = launch_python(
        tmp_path,
        "RegisterEventHandler(OnProcessExit(target_action=waiter, on_exit=[jsb])), waiter",
        f"{CHAIN}waiter = {waiter}",
    )
    assert [process.executable for process in launched.processes] == [executable, "spawner"]
    assert launched.unfired_handlers == ()


def test_a_transitions_handler_asks_its_matcher(tmp_path):
    """The matcher of launch_ros' OnStateTransition is asked besides the states."""
    handlers = ", ".join(
        f"RegisterEventHandler(OnStateTransition(matcher=lambda event: event.goal_state == {goal!r},"
        f" entities=[LogInfo(msg={goal!r})]))"
        for goal in ("inactive", "active", "finalized")
    )
    launched = launch_python(tmp_path, f"{handlers}, node(autostart=True)", LIFECYCLE)
    assert launched.log == ("inactive", "active")
