from pathlib import Path

import pytest

from drake_twin.description.controllers_yaml import (
    DEFAULT_UPDATE_RATE,
    ControllerManagerParameters,
    ControllerParameters,
    read_controllers,
)
from drake_twin.errors import InputError
from drake_twin.findings import Place

MANAGER = "ros__parameters: {update_rate: 50, arm: {type: position/Arm}}"
ARM = "ros__parameters: {joints: [elbow]}"


@pytest.fixture
def read(tmp_path):
    def read(text: str, namespace: str = "/robot_1", **placeholders: str) -> ControllerManagerParameters:
        file = tmp_path / "controllers.yaml"
        file.write_text(text)
        return read_controllers(file, namespace, placeholders)

    return read


@pytest.fixture
def refusal(read, tmp_path):
    def refusal(text: str, **placeholders: str) -> str:
        with pytest.raises(InputError) as raised:
            read(text, **placeholders)
        return str(raised.value).removeprefix(str(tmp_path) + "/")

    return refusal


@pytest.mark.parametrize(
    "text",
    [
        f"controller_manager:\n  {MANAGER}\narm:\n  {ARM}\n",
        f"/**:\n  controller_manager:\n    {MANAGER}\n  arm:\n    {ARM}\n",
        f"robot_1:\n  controller_manager:\n    {MANAGER}\n  arm:\n    {ARM}\n",
        f"/robot_1:\n  controller_manager:\n    {MANAGER}\n  arm:\n    {ARM}\n",
        f"/**/controller_manager:\n  {MANAGER}\n/**/arm:\n  {ARM}\n",
        f"/robot_1/controller_manager:\n  {MANAGER}\n/robot_1/arm:\n  {ARM}\n",
        f"/robot_1/controller_manager:\n  {MANAGER}\n/**:\n  arm:\n    {ARM}\n",
    ],
    ids=["top level", "below /**", "below robot_1", "below /robot_1", "/**/name", "/ns/name", "mixed"],
)
def test_every_form_in_use_gives_the_same_controller(read, text):
    manager = read(text)
    (controller,) = manager.controllers
    assert manager.update_rate == 50.0
    assert (controller.name, controller.type) == ("arm", "position/Arm")
    assert controller.names("joints") == ("elbow",)


def test_a_namespace_of_two_parts_is_matched_as_nested_keys_and_as_one_word(read):
    nested = f"fleet:\n  robot_1:\n    controller_manager:\n      {MANAGER}\n"
    word = f"/fleet/robot_1/controller_manager:\n  {MANAGER}\n"
    assert read(nested, "/fleet/robot_1").controllers[0].name == "arm"
    assert read(word, "/fleet/robot_1").controllers[0].name == "arm"


def test_two_namespaces_in_one_file_do_not_see_each_other(read):
    text = "".join(
        f"{robot}:\n  controller_manager:\n    ros__parameters: {{update_rate: {rate}, {name}: {{type: a/B}}}}\n"
        f"  {name}:\n    ros__parameters: {{joints: [{robot}_joint]}}\n"
        for robot, rate, name in (("robot_1", 10, "arm"), ("robot_2", 20, "hand"))
    )
    for namespace, rate, name in (("/robot_1", 10.0, "arm"), ("/robot_2", 20.0, "hand")):
        manager = read(text, namespace)
        assert manager.update_rate == rate
        assert [controller.name for controller in manager.controllers] == [name]
        assert manager.controllers[0].names("joints") == (f"{namespace[1:]}_joint",)
    assert read(text, "/robot_3").controllers == ()


def test_an_entry_for_the_namespace_counts_more_than_one_for_all(read):
    text = (
        "/robot_1/controller_manager:\n  ros__parameters: {update_rate: 10}\n"
        "/**:\n  ros__parameters: {update_rate: 30}\n"
        "controller_manager:\n  ros__parameters: {update_rate: 20, arm: {type: a/B}}\n"
    )
    assert read(text).update_rate == 10.0
    assert read(text, "/robot_2").update_rate == 20.0
    assert [controller.name for controller in read(text).controllers] == ["arm"]


def test_parameters_for_all_nodes_reach_each_controller(read):
    text = f"/**:\n  ros__parameters: {{speed: fast}}\ncontroller_manager:\n  {MANAGER}\narm:\n  {ARM}\n"
    assert read(text).controllers[0].parameters == {"speed": "fast", "joints": ["elbow"]}


def test_a_type_may_be_written_with_a_dot_or_in_the_controllers_own_entry(read):
    text = (
        "controller_manager:\n  ros__parameters:\n    arm.type: a/Arm\n    1: odd\n"
        "hand:\n  ros__parameters: {type: a/Hand}\n"
    )
    types = {controller.name: controller.type for controller in read(text).controllers}
    assert types == {"arm": "a/Arm", "hand": "a/Hand"}


def test_a_controller_without_an_entry_of_its_own_has_no_parameters(read):
    (controller,) = read(f"controller_manager:\n  {MANAGER}\n").controllers
    assert controller.parameters == {}


@pytest.mark.parametrize("text", ["", "# nothing\n", "controller_manager:\n  ros__parameters:\n", "/:\n  " + ARM])
def test_a_file_without_controllers_gives_none_and_the_default_rate(read, text):
    assert read(text) == ControllerManagerParameters(DEFAULT_UPDATE_RATE, False, ())


@pytest.mark.parametrize("placeholder", ["$(var prefix)", "$(var  prefix )", "${prefix}"])
def test_placeholders_take_their_values(read, placeholder):
    text = f"controller_manager:\n  {MANAGER}\narm:\n  ros__parameters: {{joints: ['{placeholder}elbow']}}\n"
    assert read(text, prefix="left_").controllers[0].names("joints") == ("left_elbow",)


@pytest.mark.parametrize("placeholder", ["$(var prefx)", "${prefx}"])
def test_a_placeholder_without_a_value_gives_the_line_and_those_that_have_one(refusal, placeholder):
    text = f"# joints\narm:\n  ros__parameters:\n    joints: [{placeholder}elbow]\n"
    assert refusal(text, prefix="left_", robot_name="r") == (
        f"controllers.yaml:4: {placeholder} has no value. Did you mean 'prefix'? Valid: prefix, robot_name."
    )


def test_a_placeholder_in_a_comment_needs_no_value(read):
    assert read(f"controller_manager: # $(var anything)\n  {MANAGER}\n").update_rate == 50.0


@pytest.mark.parametrize("rate", ["0", "-5", "5.0e-324", "fast", "true", ".inf", ".nan", "[50]"])
def test_an_update_rate_that_is_none_is_refused_with_line_and_path(refusal, rate):
    text = refusal(f"controller_manager:\n  ros__parameters:\n    update_rate: {rate}\n")
    assert text.startswith("controllers.yaml:3: controller_manager.ros__parameters.update_rate: ")
    assert text.endswith(" is not a positive rate (Hz).")


def test_a_file_that_is_no_mapping_is_refused(refusal):
    assert refusal("- arm\n") == "controllers.yaml:1: a parameters file is a mapping of node names."


def test_parameters_that_are_no_mapping_are_refused(refusal):
    text = refusal("arm:\n  ros__parameters: [a]\n")
    assert text == "controllers.yaml:2: arm.ros__parameters: the parameters of a node are a mapping."


def test_broken_yaml_gives_the_line(refusal):
    assert refusal("arm: [\n").startswith("controllers.yaml:2: this is not valid YAML")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"gone\.yaml: the parameters file cannot be read"):
        read_controllers(tmp_path / "gone.yaml", "", {})


def test_a_file_that_is_no_text_is_refused(tmp_path):
    file = Path(tmp_path / "binary.yaml")
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"binary\.yaml: the parameters file cannot be read"):
        read_controllers(file, "", {})


@pytest.mark.parametrize("value", ["elbow", "[1, 2]", "{a: b}"])
def test_a_list_of_names_that_is_none_is_refused_at_its_line(read, value):
    text = f"controller_manager:\n  {MANAGER}\narm:\n  ros__parameters:\n    joints: {value}\n"
    (controller,) = read(text).controllers
    with pytest.raises(
        InputError, match=r"controllers\.yaml:5: arm\.ros__parameters\.joints: .* is not a list of names"
    ):
        controller.names("joints")


def test_text_that_is_none_is_refused_and_text_that_is_absent_has_a_default(read):
    text = f"controller_manager:\n  {MANAGER}\narm:\n  ros__parameters:\n    interface: 5\n"
    (controller,) = read(text).controllers
    assert controller.text("frame", "base") == "base"
    with pytest.raises(InputError, match=r"controllers\.yaml:5: arm\.ros__parameters\.interface: 5 is not text"):
        controller.text("interface", "position")


def test_a_controller_that_no_file_describes_names_itself_in_errors():
    assert str(ControllerParameters("arm", "a/Arm", {}).error("it is odd")) == "controller 'arm': it is odd."


def test_later_files_add_to_earlier_ones_and_keep_what_they_do_not_say(tmp_path):
    (tmp_path / "types.yaml").write_text(
        "controller_manager: {ros__parameters: {update_rate: 50, a: {type: t/T}}}\na: {ros__parameters: {x: 1, y: 1}}"
    )
    (tmp_path / "joints.yaml").write_text("a: {ros__parameters: {joints: [j], y: 2}}")
    found = read_controllers([tmp_path / "types.yaml", tmp_path / "joints.yaml"], "/r", {})
    assert found.update_rate == 50
    assert found.controllers[0].parameters == {"x": 1, "y": 2, "joints": ["j"]}


def test_controllers_come_in_the_order_of_the_file_whatever_the_hash_seed(tmp_path):
    import os
    import subprocess
    import sys

    file = tmp_path / "c.yaml"
    names = [f"controller_{index}" for index in (5, 3, 9, 1, 7)]
    nodes = "".join(f"{name}: {{ros__parameters: {{type: t/T}}}}\n" for name in names)
    file.write_text("/**: {ros__parameters: {use_sim_time: true}}\n" + nodes)
    program = (
        "from pathlib import Path; from drake_twin.description.controllers_yaml import read_controllers;"
        f"print([c.name for c in read_controllers(Path({str(file)!r}), '/r', {{}}).controllers])"
    )
    for seed in "123":
        command = [sys.executable, "-c", program]
        environment = os.environ | {"PYTHONHASHSEED": seed}
        printed = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
        assert printed.strip() == str(names)


def test_parameters_of_one_controller_go_together_however_they_are_nested_and_in_whatever_file(tmp_path):
    one, other = tmp_path / "one.yaml", tmp_path / "other.yaml"
    one.write_text(
        "controller_manager: {ros__parameters: {pid: {type: pid/Pid}}}\n"
        "pid:\n  ros__parameters:\n    gains.a.p: 1\n    gains: {a: {d: 2}, b: {p: 3}}\n"
    )
    other.write_text("pid:\n  ros__parameters:\n    gains: {a: {i: 4}}\n    gains.b.p: 5\n")
    (controller,) = read_controllers([one, other], "/robot_1", {}).controllers
    assert controller.parameters == {"gains": {"a": {"p": 1, "d": 2, "i": 4}, "b": {"p": 5}}}
    places = {name: controller.place("gains", *name.split(".")) for name in ("a.p", "a.d", "a.i", "b.p")}
    assert places == {
        "a.p": Place(str(one), 4),
        "a.d": Place(str(one), 5),
        "a.i": Place(str(other), 3),
        "b.p": Place(str(other), 4),
    }


def test_what_the_controller_manager_does_not_read_is_said_with_its_line(read, tmp_path):
    text = (
        "controller_manager:\n  ros__parameters:\n    update_rate: 50\n    use_sim_tim: true\n"
        "    hardware_components_initial_state.shutdown_on_initial_state_failure: true\n"
        "    lost: {typ: a/B}\n    thread_priority: 50\n"
    )
    on_failure = "hardware_components_initial_state.shutdown_on_initial_state_failure"
    said = {finding.lines[0]: finding.what for finding in read(text).findings}
    assert said == {
        4: "controller_manager: unknown parameter 'use_sim_tim': it is ignored",
        5: f"controller_manager: {on_failure} is ignored: simulated hardware does not fail",
        6: "controller_manager: 'lost' has no type, so it is not a controller: it is ignored",
        7: "controller_manager: thread_priority is ignored: the twin has no process for it",
    }


@pytest.mark.parametrize(
    "text",
    [
        """
    hardware_components_initial_state: {inactive: [arm, hand], unconfigured: [base, hand]}
    defaults: {switch_controller: {strictness: strict}}
""",
        """
    hardware_components_initial_state.inactive: [arm, hand]
    hardware_components_initial_state.unconfigured: [base, hand]
    defaults.switch_controller.strictness: strict
""",
    ],
)
def test_the_states_of_hardware_and_the_default_strictness(read, text):
    manager = read(f"controller_manager:\n  ros__parameters:{text}")
    states = {name: state for name, (state, _) in manager.hardware_states.items()}
    assert states == {"base": "unconfigured", "hand": "inactive", "arm": "inactive"}
    assert (manager.strictness, manager.uses_inactive_hardware, manager.findings) == (2, False, ())
    assert manager.hardware_states["base"][1].line is not None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("defaults: {switch_controller: {strictness: lax}}", "unknown strictness 'lax'"),
        ("hardware_components_initial_state: {inactive: arm}", "'arm' is not a list of hardware components"),
        ("defaults.allow_controller_activation_with_inactive_hardware: maybe", "'maybe' is neither true nor false"),
    ],
)
def test_wrong_values_of_the_controller_managers_groups_are_refused_with_their_line(read, text, message):
    with pytest.raises(InputError, match=message) as error:
        read(f"controller_manager:\n  ros__parameters:\n    {text}\n")
    assert error.value.line == 3


def test_fallback_controllers_of_the_manager_and_of_the_controller(read):
    text = (
        "controller_manager:\n  ros__parameters:\n    a: {type: t/A, fallback_controllers: [b]}\n"
        "    b: {type: t/B}\n    b.fallback_controllers: [c]\n    c: {type: t/C}\n"
        "c:\n  ros__parameters: {fallback_controllers: [a, b]}\n"
    )
    manager = read(text)
    fallbacks = {controller.name: controller.names("fallback_controllers") for controller in manager.controllers}
    assert fallbacks == {"a": ("b",), "b": ("c",), "c": ("a", "b")}
    assert manager.findings == ()


@pytest.mark.parametrize(
    ("text", "what", "line"),
    [
        (f"controller_manager:\n  {MANAGER}\narm:\n  ros__paramters: {{joints: [elbow]}}\n", "ros__paramters", 4),
        (f"controller_manager:\n  {MANAGER}\nroot:\n  ros_parameters: {{joints: [elbow]}}\n", "ros_parameters", 4),
    ],
)
def test_a_key_that_is_nearly_ros_parameters_is_a_finding_with_its_line(read, text, what, line):
    (finding,) = read(text).findings
    told = f"the key {what!r}: what is below it belongs to no node. Did you mean 'ros__parameters'?"
    assert (finding.what, finding.lines) == (told, (line,))


def test_parameters_of_a_node_that_is_nearly_a_controller_are_a_finding_with_their_line(read):
    manager = MANAGER.replace("arm", "arm_controller")
    for name, told in (("arm_contrller", 1), ("arm_controller", 0), ("ekf_filter_node", 0)):
        found = read(f"controller_manager:\n  {manager}\n{name}:\n  {ARM}\n").findings
        assert [(item.lines, "Did you mean 'arm_controller'?" in item.what) for item in found] == [((4,), True)] * told
