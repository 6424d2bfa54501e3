"""Message packages as modules: drake_twin's own and a workspace's."""

import importlib.util
import subprocess
import sys
from importlib.abc import Loader, MetaPathFinder

import pytest
from interface_packages import folder_of, write_package

from drake_twin import InputError
from drake_twin.nodes.interface_files import InterfaceFiles
from drake_twin.nodes.interfaces import Interfaces
from drake_twin.nodes.message_classes import from_wire, message_class, to_wire, type_name


class Finder(MetaPathFinder, Loader):
    """Puts the modules of a source under their own names."""

    def __init__(self, source):
        self.source = source

    def find_spec(self, fullname, path=None, target=None):
        module = self.source(fullname)
        if module is None:
            return None
        spec = importlib.util.spec_from_loader(fullname, self, is_package=hasattr(module, "__path__"))
        spec.loader_state = module
        return spec

    def create_module(self, spec):
        return spec.loader_state

    def exec_module(self, module):
        pass


@pytest.fixture
def importable(monkeypatch):
    """Returns a function that lets a source's modules be imported, until the test ends."""
    before = set(sys.modules)
    finders = []

    def put(source):
        finders.append(Finder(source))
        sys.meta_path.insert(0, finders[-1])

    yield put
    for finder in finders:
        sys.meta_path.remove(finder)
    for name in set(sys.modules) - before:
        del sys.modules[name]


def test_twins_own_types(importable):
    importable(Interfaces().source)
    from builtin_interfaces.msg import Duration, Time
    from control_msgs.action import FollowJointTrajectory
    from geometry_msgs.msg import Twist
    from geometry_msgs.msg._twist import Twist as FromItsFile
    from rcl_interfaces.msg import ParameterType
    from std_srvs.srv import Trigger
    from std_srvs.srv._trigger import Trigger_Response

    assert Twist is FromItsFile is message_class("geometry_msgs/msg/Twist")
    assert (Time(sec=3).nanosec, Duration(nanosec=5).sec) == (0, 0)
    assert ParameterType.PARAMETER_DOUBLE == 3  # rcl_interfaces/msg/ParameterType.msg
    assert Trigger.Response(success=True, message="x").message == "x"
    assert Trigger.Response is Trigger_Response
    assert (
        FollowJointTrajectory.Result.PATH_TOLERANCE_VIOLATED == -4
    )  # control_msgs/action/FollowJointTrajectory.action
    assert FollowJointTrajectory.Goal().trajectory.points == []
    assert type(FollowJointTrajectory.Impl.FeedbackMessage().feedback) is FollowJointTrajectory.Feedback
    assert FollowJointTrajectory.Impl.SendGoalService.Request().goal == FollowJointTrajectory.Goal()
    types = [type_name(each) for each in (Twist, Trigger, Trigger.Request, FollowJointTrajectory)]
    assert types == [
        "geometry_msgs/msg/Twist",
        "std_srvs/srv/Trigger",
        "std_srvs/srv/Trigger_Request",
        "control_msgs/action/FollowJointTrajectory",
    ]
    for each in (Trigger, FollowJointTrajectory):  # rosidl_generator_py/resource/_srv.py.em, _action.py.em: __init__
        with pytest.raises(NotImplementedError, match="can not be instantiated"):
            each()
    with pytest.raises(TypeError):
        type_name(int)
    with pytest.raises(ImportError):
        from std_srvs.srv import Trigger_Request  # noqa: F401
    with pytest.raises(ImportError):
        from geometry_msgs.msg import Twits  # noqa: F401
    with pytest.raises(ModuleNotFoundError):
        import geometry_msgs.msg._twits  # noqa: F401


def test_star_imports_give_all_names(importable):
    importable(Interfaces().source)
    names = {}
    exec("from std_srvs.srv import *", names)
    assert {"Empty", "SetBool", "Trigger"} <= names.keys()
    assert not [name for name in names if name.endswith("_Request")]


@pytest.fixture
def workspace(tmp_path):
    """A package with Python modules and interfaces, which needs types of another one, and of drake_twin."""
    robot = write_package(
        tmp_path,
        "some_robot",
        msg={"Wheel": "other_msgs/Speed speed\nstd_msgs/Header header\nSide side", "Side": "bool left true"},
        srv={"Turn": "Wheel[] wheels\n---\nbool success\n"},
        action={"Drive": "float64 distance\n---\nuint8 OK=1\nuint8 code\n---\nWheel[2] wheels\n"},
    )
    inner = robot / "some_robot"
    inner.mkdir()
    (inner / "__init__.py").write_text("origin = 'user'\n")
    (inner / "module.py").write_text("from some_robot.msg import Wheel\ny = Wheel()\n")
    other = write_package(tmp_path, "other_msgs", msg={"Speed": "float64 value 1.5 # m/s\n"})
    return robot, other


def test_a_package_with_python_modules_and_messages(workspace, importable, monkeypatch):
    robot, other = workspace
    importable(Interfaces(folder_of(robot, other)).source)
    monkeypatch.syspath_prepend(str(robot))
    from other_msgs.msg import Speed
    from some_robot import origin
    from some_robot.action import Drive
    from some_robot.module import y
    from some_robot.msg import Wheel
    from some_robot.srv import Turn

    assert origin == "user"
    assert type(y) is Wheel
    assert y.speed == Speed(value=1.5)
    assert y.side.left is True
    assert Drive.Result.OK == 1
    sent = Turn.Request(wheels=[Wheel(), Wheel()])
    assert from_wire("some_robot/srv/Turn_Request", to_wire(sent)) == sent
    assert len(Drive.Feedback().wheels) == 2


def test_nothing_is_left_behind(workspace):
    before = dict(sys.modules)
    source = Interfaces(folder_of(*workspace)).source
    assert source("other_msgs.msg").Speed().value == 1.5
    assert source("geometry_msgs").__path__ == []
    assert {
        name for name in sys.modules if name not in before and not name.startswith(("drake_twin", "rosbags"))
    } == set()


def test_other_modules_are_left_alone(workspace):
    robot, other = workspace
    source = Interfaces(folder_of(robot, other)).source
    for name in ("numpy", "some_robot", "some_robot.module", "geometry_msgs.other", "other_msgs.srv", "nowhere.msg"):
        assert source(name) is None, name
    assert source("other_msgs").__path__ == []


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"msg": {"A": "int32 a\n\nfloat 3 x\n"}}, "msg/A.msg:3: 'float 3 x' is neither a field (TYPE NAME) nor a"),
        ({"msg": {"A": "int32 a\nNope b # c\n"}}, "msg/A.msg:2: type bad_{}/msg/Nope does not exist."),
        ({"msg": {"A": "B b\n", "B": "int32 x y z\n"}}, "msg/B.msg:1: wrong default value: x: 'y z' is not a int32."),
        ({"msg": {"A": "int32 a\n---\n"}}, "msg/A.msg: a msg file needs 0 lines of ---, but it has 1."),
        ({"srv": {"A": "int32 a\n"}}, "srv/A.srv: a srv file needs 1 lines of ---, but it has 0."),
        ({"action": {"A": "int32 a\n---\nint32 b\n"}}, "action/A.action: a action file needs 2 lines of ---"),
        ({"msg": {"A": "int32 a\nint8 b\nstring a\n"}}, "msg/A.msg:3: there are several fields 'a'."),
        ({"msg": {"A": "int32 a\nA b\n"}}, "msg/A.msg:2: bad_{}/msg/A has a field of bad_{}/msg/A, which is made of"),
        ({"msg": {"A": "B b\n", "B": "A[] a\n"}}, "msg/B.msg:1: bad_{}/msg/B has a field of bad_{}/msg/A, which is"),
        ({"msg": {"A": "\nint32[3] a [1, 2]\n"}}, "msg/A.msg:2: wrong default value: a: 2 elements, but 3 are needed."),
    ],
)
def test_errors_name_file_and_line(tmp_path, files, message):
    name = f"bad_{tmp_path.name}"
    package = write_package(tmp_path, name, **files)
    (kind,) = files
    module = Interfaces(folder_of(package)).source(f"{name}.{kind}")
    with pytest.raises(InputError) as refusal:
        _ = module.A
    expected = message.replace("bad_{}", name)
    assert expected in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).startswith(str(package))


def test_a_file_that_cannot_be_read(tmp_path):
    package = write_package(tmp_path, "bad_bytes_msgs", msg={"A": ""})
    (package / "msg" / "A.msg").write_bytes(b"int32 a # \xff\n")
    with pytest.raises(InputError, match=r"A.msg: the file cannot be read"):
        _ = Interfaces(folder_of(package)).source("bad_bytes_msgs.msg").A


def test_another_workspaces_definition_is_refused(tmp_path):
    first = write_package(tmp_path / "first", "twice_msgs", msg={"A": "int32 a\n"})
    second = write_package(tmp_path / "second", "twice_msgs", msg={"A": "int64 a\n"})
    made = Interfaces(folder_of(first)).source("twice_msgs.msg").A
    assert Interfaces(folder_of(first)).source("twice_msgs.msg").A is made
    with pytest.raises(InputError, match=r"second.*A.msg: twice_msgs/msg/A is defined differently in .*first.*A.msg"):
        _ = Interfaces(folder_of(second)).source("twice_msgs.msg").A


def test_drake_twins_own_definition_counts(tmp_path, caplog):
    package = write_package(tmp_path, "geometry_msgs", msg={"Point": "float32 x\n", "Own": "Point point\n"})
    module = Interfaces(folder_of(package)).source("geometry_msgs.msg")
    assert module.Own().point == message_class("geometry_msgs/msg/Point")()
    assert module.Point is message_class("geometry_msgs/msg/Point")
    assert caplog.text.count("drake_twin has geometry_msgs/msg/Point with other fields, which count") == 1


def test_a_workspaces_own_version_of_a_package_counts(tmp_path):
    """Nav2, MoveIt and the like are built from source, too, in other versions than Jazzy's. Types are a process's."""
    texts = {"GeoPoint": "float32 latitude\n", "GeoPath": "GeoPoint[] points\n"}
    package = write_package(tmp_path, "geographic_msgs", msg=texts)
    script = f"""
from pathlib import Path
from drake_twin.nodes.interfaces import Interfaces
module = Interfaces({{"geographic_msgs": Path({str(package)!r})}}.get).source("geographic_msgs.msg")
print(module.GeoPath.get_fields_and_field_types(), module.GeoPoint.get_fields_and_field_types(), module.__all__)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert done.stdout == (
        "{'points': 'sequence<geographic_msgs/GeoPoint>'} {'latitude': 'float'} ['GeoPath', 'GeoPoint']\n"
    )
    assert "BoundingBox" in Interfaces().source("geographic_msgs.msg").__all__


def test_a_workspaces_version_that_comes_too_late(tmp_path, caplog):
    """The types are those of the whole process, and messages of them may be under way."""
    Interfaces().find("polygon_msgs/msg/Point2D")
    package = write_package(tmp_path, "polygon_msgs", msg={"Point2D": "float32 x\n"})
    found = Interfaces(folder_of(package)).find("polygon_msgs/msg/Point2D")
    assert found.get_fields_and_field_types() == {"x": "double", "y": "double"}
    assert "drake_twin has polygon_msgs/msg/Point2D with other fields, which count" in caplog.text


def test_modules_of_nav2_and_moveit():
    source = Interfaces().source
    goal = source("nav2_msgs.action").NavigateToPose.Goal(behavior_tree="tree.xml")
    assert goal.get_fields_and_field_types() == {"pose": "geometry_msgs/PoseStamped", "behavior_tree": "string"}
    assert source("moveit_msgs.msg").MoveItErrorCodes.PLANNING_FAILED == -1
    assert source("geographic_msgs.msg").GeoPoint(latitude=47.5).latitude == 47.5
    assert source("vision_msgs.msg").Detection2DArray().detections == []


def test_a_field_of_a_type_that_no_file_can_have_is_refused(tmp_path):
    (tmp_path / "msg").mkdir()
    (tmp_path / "msg" / "Own.msg").write_text(f"strange_msgs/{'A' * 300} field\n")
    with pytest.raises(InputError, match="AAAA"):
        InterfaceFiles(lambda package: tmp_path).load("strange_msgs/msg/Own")
