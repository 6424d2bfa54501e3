import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from launch_files import launch_python, launch_xml, write, write_package, write_python

from drake_twin.description.package_index import PackageIndex, share_folder
from drake_twin.description.xacro_file import places_of_expanded
from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate
from drake_twin.ros2.stand_in_modules import exports, stand_in

TREE = Path(stand_in.__code__.co_filename).parent
ROVER = share_folder("models") / "rover_gazebo" / "launch" / "main.launch.xml"

MESSY = """
import sys
import ros_decoy_helper
os.environ["LEFT_BEHIND"] = "1"
os.environ.pop("HOME", None)
os.chdir("/")
sys.path.append("/left/behind")
sys.modules["left_behind"] = sys
sys.modules["yaml"] = None
sys.argv.append("x")
"""


def state():
    """What a launch file may not change; modules of Python's own library may be loaded on the way."""
    modules = {
        name: module for name, module in sys.modules.items() if name.partition(".")[0] not in sys.stdlib_module_names
    }
    return modules, list(sys.path), dict(os.environ), os.getcwd(), list(sys.argv), list(sys.meta_path)


@pytest.mark.parametrize("end", ["", "raise RuntimeError()", "raise SystemExit(1)", "import no_such_module"])
def test_a_launch_file_leaves_no_trace_however_it_ends(tmp_path, end):
    write(tmp_path / "ros_decoy_helper.py", "x = 1\n")
    launch_python(tmp_path, "")  # what the room itself loads on first use stays
    before = state()
    path_list = sys.path
    try:
        launch_python(tmp_path, "LogInfo(msg='x')", before=MESSY + end)
        assert not end
    except InputError:
        assert end
    assert state() == before
    assert sys.path is path_list
    assert not list(tmp_path.rglob("__pycache__"))


def test_a_nested_include_that_fails_leaves_no_trace(tmp_path):
    write_python(tmp_path / "inner.launch.py", "1 / 0", before="os.environ['A'] = '1'")
    write(tmp_path / "middle.launch.xml", '<launch><include file="$(dirname)/inner.launch.py"/></launch>')
    launch_xml(tmp_path, "<push_environment/>")  # what the room itself loads on first use stays
    launch_python(tmp_path, "")
    before = state()
    with pytest.raises(InputError, match="ZeroDivisionError"):
        launch_xml(tmp_path, '<set_env name="B" value="2"/><include file="$(dirname)/middle.launch.xml"/>')
    assert state() == before


def test_modules_of_pythons_own_library_may_stay_but_nothing_of_ros(tmp_path):
    launch_python(tmp_path, "", before="import launch_ros.actions, colorsys, xacro")
    assert not [
        name for name in sys.modules if name.partition(".")[0] in ("launch", "launch_ros", "ament_index_python")
    ]


def test_a_sourced_ros_changes_nothing(tmp_path):
    decoy = tmp_path / "ros"
    for name in ("launch", "launch_ros", "ament_index_python", "xacro", "launch_xml", "nav2_common"):
        write(decoy / name / "__init__.py", f"raise RuntimeError('the decoy {name} is used')\n")
    root = Path(__file__).parents[2]
    code = "import sys; from drake_twin.ros2.evaluate import evaluate; print(repr(evaluate(sys.argv[1])))"

    def run(**more):
        environment = os.environ | more
        command = [sys.executable, "-c", code, str(ROVER)]
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=root, env=environment).stdout

    sourced = run(PYTHONPATH=str(decoy), AMENT_PREFIX_PATH=str(tmp_path / "none"), ROS_DISTRO="humble")
    assert sourced == run()
    assert "robot_2_front_left_wheel_joint" in sourced


def test_modules_that_are_loaded_already_are_put_aside_and_back(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "launch", object())
    monkeypatch.setitem(sys.modules, "launch.actions", object())
    theirs = sys.modules["launch"]
    assert launch_python(tmp_path, "LogInfo(msg='ours')").log == ("ours",)
    assert sys.modules["launch"] is theirs


@pytest.mark.parametrize(
    "line",
    [
        "import launch; assert launch.substitutions.LaunchConfiguration",
        "import launch_ros.actions; assert launch_ros.descriptions.ComposableNode",
        "from launch.actions.execute_process import ExecuteProcess",
        "from launch.substitutions.path_join_substitution import PathJoinSubstitution",
        "from launch.event_handlers.on_process_exit import OnProcessExit",
        "from launch.event_handlers.on_execution_complete import OnExecutionComplete",
        "from launch.launch_description import LaunchDescription",
        "from launch_ros.actions.node import Node",
        "from launch.some_substitutions_type import SomeSubstitutionsType",
        "from launch_xml.launch_description_sources import XMLLaunchDescriptionSource",
        "from launch_yaml.launch_description_sources import YAMLLaunchDescriptionSource",
        "from ament_index_python import get_package_share_path, PackageNotFoundError",
        "from launch.logging import get_logger; get_logger('x').debug('y')",
        "from launch_ros.parameter_descriptions import ParameterFile, ParameterValue, Parameter",
        "from launch import LaunchService, LaunchIntrospector, LaunchContext, Substitution, Action, Condition",
        "from lifecycle_msgs.msg import Transition",
        "from controller_manager.launch_utils import generate_load_controller_launch_description",
        "from launch_testing.actions import ReadyToTest",
        "from ros_gz_sim.actions import GzServer; from ros_gz_bridge.actions import RosGzBridge",
        "import launch.actions.shutdown_action, launch.actions.shutdown, launch.substitutions.boolean_substitution",
        "from launch.frontend import Entity, Parser, expose_action; from launch.frontend.entity import Entity as E",
        "from launch_ros.utilities import evaluate_parameters; assert callable(evaluate_parameters)",
        "from launch.event_handlers import event_named; assert callable(event_named)",
    ],
)
def test_ros_modules_are_importable_the_way_launch_files_do(tmp_path, line):
    assert launch_python(tmp_path, "LogInfo(msg='x')", before=line).log == ("x",)


@pytest.mark.parametrize(
    ("module", "package", "name"),
    [
        ("launch.actions.timer_action", "launch.actions", "TimerAction"),
        ("launch.actions.log_warning", "launch.actions", "LogWarning"),
        ("launch.action", "launch", "Action"),
        ("launch.substitution", "launch.substitutions", "Substitution"),
        ("launch.events.matchers", "launch.events.process", "matches_action"),
        ("launch_ros.parameter_descriptions", "launch_ros.descriptions", "ParameterFile"),
        ("launch_ros.substitutions.find_package", "launch_ros.substitutions", "FindPackageShare"),
        ("ament_index_python.packages", "ament_index_python", "get_package_share_directory"),
    ],
)
def test_a_class_is_the_same_whichever_module_it_is_imported_from(tmp_path, module, package, name):
    before = f"from {module} import {name} as one\nimport {package}\nassert {package}.{name} is one"
    assert launch_python(tmp_path, "LogInfo(msg='x')", before=before).log == ("x",)
    assert stand_in(module, name) is stand_in(package, name)


def test_every_module_of_the_tree_has_its_names():
    for file in TREE.glob("*/**/*.py"):
        if file.parent != TREE:
            parts = file.relative_to(TREE).with_suffix("").parts
            module = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            assert all(stand_in(module, name) is not None for name in exports(module) or ())


def test_a_files_own_package_and_its_neighbours_are_importable(tmp_path):
    own, other = write_package(tmp_path, "own_pkg"), write_package(tmp_path, "other_pkg")
    write(own / "own_pkg" / "__init__.py", "")
    write(own / "own_pkg" / "names.py", "NAME = 'own'\n")
    write(other / "other_pkg" / "__init__.py", "NAME = 'other'\n")
    write(own / "launch" / "beside.py", "NAME = 'beside'\n")
    file = write_python(
        own / "launch" / "x.launch.py",
        "LogInfo(msg=[own_pkg.names.NAME, other_pkg.NAME, beside.NAME])",
        before="import own_pkg.names, other_pkg, beside",
    )
    assert evaluate(file, {}, PackageIndex()).log == ("ownotherbeside",)
    assert not {"own_pkg", "other_pkg", "beside"} & set(sys.modules)


def test_a_launch_file_may_start_the_xacro_command(tmp_path):
    write(
        tmp_path / "r.xacro",
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default=""/>'
        '<xacro:include filename="$(find parts)/part.xacro"/><link name="$(arg n)"/></robot>',
    )
    write(write_package(tmp_path, "parts") / "part.xacro", '<robot><link name="part"/></robot>')
    launched = launch_python(
        tmp_path,
        "LogInfo(msg=subprocess.run(['xacro', os.path.join(os.path.dirname(__file__), 'r.xacro'), 'n:=base'],"
        " capture_output=True, text=True, check=True).stdout)",
        before="import subprocess",
    )
    assert '<link name="part"/>' in launched.log[0]
    assert '<link name="base"/>' in launched.log[0]


def test_xacro_finds_packages_in_a_launch_files_own_code(tmp_path):
    package = write_package(tmp_path, "robots")
    write(package / "part.xacro", '<robot><link name="part"/></robot>')
    write(
        tmp_path / "r.xacro",
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find robots)/part.xacro"/></robot>',
    )
    for code in ("xacro.process_file(f).toxml()", "document.toxml()", "xacro.process(f)"):
        launched = launch_python(
            tmp_path,
            f"LogInfo(msg={code})",
            before="import xacro\nf = os.path.join(os.path.dirname(__file__), 'r.xacro')\n"
            "document = xacro.parse(open(f))\nxacro.process_doc(document)",
        )
        assert '<link name="part"/>' in launched.log[0]


XACRO_IN_CODE = "import xacro\nf = os.path.join(os.path.dirname(__file__), 'r.xacro')\n"
OF_XACRO = {
    "file": ("", "xacro.process_file(f).toxml()"),
    "pretty": ("", "xacro.process_file(f).toprettyxml(indent='  ')"),
    "document": ("document = xacro.parse(open(f))\nxacro.process_doc(document)", "document.toxml()"),
}


@pytest.mark.parametrize("form", OF_XACRO)
def test_a_text_that_a_launch_files_own_code_makes_by_xacro_has_the_places_of_its_files(tmp_path, form):
    before, code = OF_XACRO[form]
    robot = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<xacro:include filename="part.xacro"/></robot>'
    )
    write(tmp_path / "r.xacro", robot)
    write(tmp_path / "part.xacro", '<robot>\n\n<link name="part"/></robot>')
    launched = launch_python(tmp_path, f"LogInfo(msg={code})", before=XACRO_IN_CODE + before)
    places = [(Path(place.file).name, place.line) for place in places_of_expanded(launched.log[0])]
    assert places == [("r.xacro", 1), ("part.xacro", 3)]


def test_an_error_of_xacro_in_a_launch_files_own_code_has_xacros_file_and_line(tmp_path):
    robot = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<link name="${no}"/></robot>'
    write(tmp_path / "r.xacro", robot)
    with pytest.raises(InputError) as refused:
        launch_python(tmp_path, "LogInfo(msg=xacro.process_file(f).toxml())", before=XACRO_IN_CODE)
    assert re.fullmatch(
        r"\S+/r.xacro:2: xacro: name 'no' is not defined when evaluating expression 'no', called by \S+\.py:\d+\.",
        str(refused.value),
    )


@pytest.mark.parametrize(
    ("entity", "what"),
    [
        (
            "Node(package='p', executable='e', parameters=[{'a': Command(['xacro ', '/gone/r.xacro'])}])",
            "r.xacro does not",
        ),
        (
            "Node(package='p', executable='e', parameters=[ParameterFile('/gone/p.yaml', allow_substs=True)])",
            "p.yaml cannot",
        ),
    ],
)
def test_a_file_that_is_gone_is_refused_with_the_line_of_the_launch_file(tmp_path, entity, what):
    before = "from launch_ros.parameter_descriptions import ParameterFile"
    with pytest.raises(InputError, match=rf"^{tmp_path}/\S+\.py:\d+: .*/gone/{what}"):
        launch_python(tmp_path, entity, before)


def test_a_package_that_a_file_is_prepared_to_miss_raises_what_it_expects(tmp_path):
    launched = launch_python(
        tmp_path,
        "LogInfo(msg=share)",
        before="from ament_index_python.packages import PackageNotFoundError\n"
        "try:\n    share = get_package_share_directory('gone')\n"
        "except PackageNotFoundError:\n    share = 'fallback'",
    )
    assert launched.log == ("fallback",)


def test_a_packages_prefix_holds_its_share_folder(tmp_path):
    package = write_package(tmp_path, "robots")
    launched = launch_python(
        tmp_path,
        "LogInfo(msg=os.path.realpath(os.path.join(get_package_prefix('robots'), 'share', 'robots'))),"
        "LogInfo(msg=[FindPackagePrefix('robots'), '/share'])",
        before="from ament_index_python.packages import get_package_prefix",
    )
    assert launched.log[0] == str(package)
    assert (Path(launched.log[1]) / "robots" / "package.xml").is_file()
