import os

import pytest
from launch_files import launch_python

from drake_twin.errors import InputError


def logged(folder, entities, before="", **arguments):
    return list(launch_python(folder, entities, before, **arguments).log)


def test_configurations_are_set_and_unset(tmp_path):
    assert logged(
        tmp_path,
        """SetLaunchConfiguration("a", "1"), LogInfo(msg=LaunchConfiguration("a")), UnsetLaunchConfiguration("a"),
        LogInfo(msg=LaunchConfiguration("a", default="gone")), DeclareLaunchArgument("a", default_value="2"),
        SetLaunchConfiguration("a", [LaunchConfiguration("a"), "3"]), LogInfo(msg=LaunchConfiguration("a")),""",
    ) == ["1", "gone", "23"]


def test_a_group_is_a_scope_of_configurations_environment_and_namespace(tmp_path):
    launched = launch_python(
        tmp_path,
        """SetLaunchConfiguration("a", "outer"),
        GroupAction([PushRosNamespace("r"), SetLaunchConfiguration("a", "inner"), SetEnvironmentVariable("E", "1"),
                     SetRemap("x", "y"), SetParameter("p", 1),
                     Node(package="p", executable="e", name=LaunchConfiguration("a"))]),
        Node(package="p", executable="e", name=LaunchConfiguration("a")),""",
    )
    inner, outer = launched.processes
    assert (inner.full_name, inner.remappings, inner.parameters) == ("/r/inner", (("x", "y"),), ({"p": 1},))
    assert inner.environment == {"E": "1"}
    assert (outer.full_name, outer.remappings, outer.parameters, outer.environment) == ("/outer", (), (), {})


def test_a_group_without_a_scope_changes_what_follows(tmp_path):
    entities = 'GroupAction([SetLaunchConfiguration("a", "1")], scoped=False), LogInfo(msg=LaunchConfiguration("a"))'
    assert logged(tmp_path, entities) == ["1"]


def test_a_group_may_be_shut_off_from_what_is_outside(tmp_path):
    assert logged(
        tmp_path,
        """SetLaunchConfiguration("a", "1"), SetLaunchConfiguration("b", "2"),
        GroupAction([LogInfo(msg=[LaunchConfiguration("a", default="-"), LaunchConfiguration("b", default="-")])],
                    forwarding=False, launch_configurations={"b": LaunchConfiguration("b")}),""",
    ) == ["-2"]


def test_a_groups_scope_ends_when_an_include_in_it_fails(tmp_path):
    assert logged(
        tmp_path,
        """SetLaunchConfiguration("a", "1"),
        GroupAction([SetLaunchConfiguration("a", "2"),
                     IncludeLaunchDescription([FindPackageShare("gone"), "/x.launch.py"]),
                     PushLaunchConfigurations()]),
        LogInfo(msg=LaunchConfiguration("a")),""",
    ) == ["1"]


def test_the_environment_is_set_appended_unset_and_restored(tmp_path, monkeypatch):
    monkeypatch.setenv("THERE", "old")
    launched = launch_python(
        tmp_path,
        """SetEnvironmentVariable("A", ["x", TextSubstitution(text="y")]), AppendEnvironmentVariable("A", "z"),
        AppendEnvironmentVariable("A", "first", prepend=True, separator=";"), AppendEnvironmentVariable("NEW", "n"),
        UnsetEnvironmentVariable("THERE"), Node(package="p", executable="e", additional_env={"OWN": "o"}),
        ResetEnvironment(), Node(package="p", executable="e"),""",
    )
    first, second = launched.processes
    assert first.environment == {"A": "first;xy:z", "NEW": "n", "THERE": None, "OWN": "o"}
    assert second.environment == {}
    assert os.environ["THERE"] == "old"


def test_scopes_may_be_opened_and_left_by_hand(tmp_path):
    assert logged(
        tmp_path,
        """PushLaunchConfigurations(), SetLaunchConfiguration("a", "1"), PopLaunchConfigurations(),
        LogInfo(msg=LaunchConfiguration("a", default="gone")),
        PushEnvironment(), SetEnvironmentVariable("A", "1"), PopEnvironment(),
        LogInfo(msg=EnvironmentVariable("A", default_value="gone")),
        SetLaunchConfiguration("b", "1"), ResetLaunchConfigurations({"c": "2"}),
        LogInfo(msg=[LaunchConfiguration("b", default="gone"), LaunchConfiguration("c")]),""",
    ) == ["gone", "gone", "gone2"]


@pytest.mark.parametrize("action", ["PopLaunchConfigurations()", "PopEnvironment()"])
def test_leaving_a_scope_that_was_not_opened_is_refused(tmp_path, action):
    with pytest.raises(InputError, match=r"test.launch.py:17: Pop\w+ without Push"):
        launch_python(tmp_path, action)


def test_an_opaque_function_may_return_nothing_one_entity_or_several(tmp_path):
    before = "def f(context, what):\n    return what\n"
    entities = ", ".join(
        f"OpaqueFunction(function=f, args=[{what}])"
        for what in (
            "None",
            "LogInfo(msg='one')",
            "[LogInfo(msg='a'), LogInfo(msg='b')]",
            "LaunchDescription([LogInfo(msg='d')])",
        )
    )
    assert logged(tmp_path, entities, before) == ["one", "a", "b", "d"]


def test_a_coroutine_runs_to_its_end(tmp_path):
    before = "import asyncio\nseen = []\nasync def f(context):\n    await asyncio.sleep(0)\n    seen.append('x')\n"
    entities = "OpaqueCoroutine(coroutine=f), OpaqueFunction(function=lambda context: [LogInfo(msg=seen)])"
    assert logged(tmp_path, entities, before) == ["x"]


def test_timers_run_in_simulation_time_in_order(tmp_path):
    launched = launch_python(
        tmp_path,
        """TimerAction(period=5.0, actions=[Node(package="p", executable="late")]),
        TimerAction(period=LaunchConfiguration("t"), actions=[Node(package="p", executable="early"),
            TimerAction(period="1", actions=[Node(package="p", executable="nested")])]),
        Node(package="p", executable="first"),""",
        t="2.5",
    )
    assert [(process.executable, process.start_time) for process in launched.processes] == [
        ("first", 0.0),
        ("early", 2.5),
        ("nested", 3.5),
        ("late", 5.0),
    ]


def test_a_timer_without_a_number_is_refused(tmp_path):
    with pytest.raises(InputError, match="the timer's period is 'soon', which is not a number of seconds"):
        launch_python(tmp_path, "TimerAction(period='soon', actions=[])")


def test_a_canceled_timer_does_nothing(tmp_path):
    before = "timer = TimerAction(period=5.0, actions=[LogInfo(msg='late')])"
    entities = "timer, TimerAction(period=1.0, actions=[OpaqueFunction(function=lambda context: timer.cancel())])"
    assert logged(tmp_path, entities, before) == []


def test_loops_visit_what_each_round_returns(tmp_path):
    assert logged(
        tmp_path,
        """ForLoop("2", function=lambda i: [LogInfo(msg=f"r{i}")]),
        ForEach("{name: 'a', x: 1.5};{name: 'b', x: 2}", function=lambda name, x: [LogInfo(msg=f"{name}{x}")]),
        ForLoop(LaunchConfiguration("n"), name="i", actions=[LogInfo(msg=ForLoopIndex("i"))]),""",
        n="2",
    ) == ["r0", "r1", "a1.5", "b2", "0", "1"]


def test_log_levels_are_shown(tmp_path):
    assert logged(tmp_path, "LogInfo(msg='a'), LogWarning(msg='b'), Log(msg='c', level='DEBUG')") == [
        "a",
        "[WARNING] b",
        "[DEBUG] c",
    ]


def test_a_shutdown_ends_the_launch(tmp_path):
    launched = launch_python(
        tmp_path,
        """TimerAction(period=1.0, actions=[Shutdown(reason="enough")]),
        TimerAction(period=2.0, actions=[Node(package="p", executable="never")]),
        Node(package="p", executable="before"),""",
    )
    assert launched.shutdown == "enough"
    assert [process.executable for process in launched.processes] == ["before"]


def test_a_launch_that_never_comes_to_rest_is_refused(tmp_path):
    before = "def again(context):\n    return [TimerAction(period=0.1, actions=[OpaqueFunction(function=again)])]\n"
    with pytest.raises(InputError, match="still has not come to rest"):
        launch_python(tmp_path, "OpaqueFunction(function=again)", before)


def test_arguments_of_the_wrong_kind_are_refused_in_the_files_own_words(tmp_path):
    with pytest.raises(InputError, match="unexpected keyword argument 'default'"):
        launch_python(tmp_path, "DeclareLaunchArgument('a', default='b')")


HANDLERS = ["OnProcessExit(on_exiit=[])", "OnProcessStart(on_strt=[])", "OnExecutionComplete(on_completed=[])"]
HANDLERS += ["OnProcessIO(on_stdot=[])", "OnShutdown(on_shutdwn=[])"]


@pytest.mark.parametrize("handler", HANDLERS)
def test_a_keyword_that_an_event_handler_does_not_have_is_refused(tmp_path, handler):
    keyword = handler.partition("(")[2].partition("=")[0]
    with pytest.raises(InputError, match=f"unexpected keyword argument '{keyword}'"):
        launch_python(tmp_path, f"RegisterEventHandler({handler})")
