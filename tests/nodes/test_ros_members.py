"""What the twin has of ROS's Python packages: nothing of them is accepted in silence."""

from pathlib import Path

import pytest

from drake_twin.nodes import docs
from drake_twin.nodes.ros_members import lines, read_members
from drake_twin.ros2.launch.actions import execute_process
from drake_twin.ros2.without_effect import AS_FINDINGS, WITHOUT_EFFECT, parameters_without_effect

PAGE = Path(docs.__file__).parents[1] / "docs" / "ros_members.md"


def silent(member, function):
    """The names under which a member's function, and the parameters that it does not read, are to be declared."""
    found = [member] if docs.does_nothing(function) else []
    return found + [f"{member}({name})" for name in docs.unread_parameters(function)]


def functions():
    """Each member that is a function or has a constructor of its own, and does not refuse."""
    for member in docs.upstream():
        function = docs.function_of(docs.ours(member))
        if function is not None and docs.support(member) is docs.Support.SUPPORTED:
            yield member, function


def test_the_page_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == docs.page()


def test_no_member_and_no_parameter_is_accepted_in_silence():
    found = [name for member, function in functions() for name in silent(member, function)]
    assert len(list(functions())) > 400
    assert [name for name in found if name not in WITHOUT_EFFECT] == []


def test_what_is_declared_is_there():
    """A name of the list that nothing has any more would excuse what comes later under it."""
    for name in (*WITHOUT_EFFECT, *AS_FINDINGS):
        member, _, parameter = name.rstrip(")").partition("(")
        function = docs.function_of(docs.ours(member))
        assert member in docs.upstream()
        assert function is not None
        if parameter:
            ours = docs.parameters(docs._tree(function))
            assert parameter in ours or (docs.upstream()[member] and "**kwargs" in ours), name


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("def f(self, callback): pass", ["f", "f(callback)"]),
        ("def f(self, callback):\n    '''Not called.'''", ["f", "f(callback)"]),
        ("def f(self): return True", ["f"]),
        ("def f(self): return 'name'", []),
        ("def f(self, a, *, b=None, **more): return a", ["f(b)", "f(more)"]),
        ("def f(self, a): self.a = a", []),
        ("def f(self, a): a = 1", ["f(a)"]),
    ],
)
def test_a_function_that_ignores_what_it_is_given_is_found(tmp_path, text, names):
    file = tmp_path / "module.py"
    file.write_text(text + "\n")
    module = {}
    exec(compile(text + "\n", str(file), "exec"), module)
    assert silent("f", module["f"]) == names


@pytest.mark.parametrize(
    ("member", "support"),
    [
        ("rclpy.node.Node.create_publisher", "supported"),
        ("rclpy.node.Node.get_parameter", "supported"),  # by a base class of another name
        ("rclpy.service.Service.send_response", "supported"),
        ("launch.LaunchService", "a finding"),
        ("rclpy.time_source.TimeSource", "supported"),
        ("launch.actions.ExecuteProcess.name", "supported"),  # by a base class
        ("rclpy.node.Node.no_such_member", "absent"),
    ],
)
def test_what_the_twin_has_of_a_member(member, support):
    assert docs.support(member) == support


def test_the_members_of_a_source_tree_are_those_that_users_import(tmp_path):
    folder = tmp_path / "robots"
    (folder / "arms").mkdir(parents=True)
    (folder / "arms" / "__init__.py").write_text("from .left_arm import Arm\n")
    (folder / "arms" / "left_arm.py").write_text(
        "from typing import TypeVar, overload\nT = TypeVar('T')\n_HIDDEN, OPEN = 1, 2\n"
        "class Arm:\n    reach: float\n"
        "    def __init__(self, name, *, side=None):\n        self.name = self._name = name\n"
        "    @overload\n    def move(self, joint): ...\n    def move(self, joint, *others, **more): pass\n"
        "    @property\n    def side(self): return 1\n    def _own(self): pass\n"
        "def grasp(arm): pass\n"
    )
    text = "\n".join(lines([folder]))
    assert text.splitlines() == [
        "robots.arms.Arm(name, side)",
        "robots.arms.Arm.move(joint, *others, **more)",
        "robots.arms.Arm.name",
        "robots.arms.Arm.reach",
        "robots.arms.Arm.side",
        "robots.arms.left_arm.OPEN",
        "robots.arms.left_arm.grasp(arm)",
    ]
    assert read_members(text)["robots.arms.left_arm.grasp"] == ["arm"]


def test_members_that_only_type_checkers_see_are_none(tmp_path):
    folder = tmp_path / "robots"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "arms.py").write_text(
        "import sys\nfrom typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    CHECKED = 1\nelse:\n    AT_RUN_TIME = 1\n"
        "if sys.platform == 'win32':\n    WINDOWS = 1\nelse:\n    OTHERS = 1\n"
        "try:\n    import fast\n    FAST = True\nexcept ImportError:\n    SLOW = True\n"
    )
    assert [*read_members("\n".join(lines([folder])))] == [
        f"robots.arms.{name}" for name in ("AT_RUN_TIME", "FAST", "OTHERS", "SLOW", "WINDOWS")
    ]


def test_attributes_of_launch_files_that_are_read_and_not_used_are_declared():
    known = {*parameters_without_effect("launch.actions.ExecuteLocal"), "respawn"}
    assert set(execute_process._IGNORED) <= known
