import sys

import pytest
from launch_files import launch_python, launch_xml, write, write_package

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate

TAGS = """
from typing import List

from launch import Action, Substitution
from launch.frontend import Entity, Parser, expose_action, expose_substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch_ros.actions import Node


@expose_action("greet")
class Greet(Action):
    def __init__(self, *, who, times=1, friends=(), **kwargs):
        super().__init__(**kwargs)
        self.who, self.times, self.friends = normalize_to_list_of_substitutions(who), times, friends

    @classmethod
    def parse(cls, entity: Entity, parser: Parser):
        _, kwargs = super().parse(entity, parser)
        kwargs["who"] = parser.parse_substitution(entity.get_attr("who"))
        times = entity.get_attr("times", data_type=int, optional=True)
        if times is not None:
            kwargs["times"] = times
        friends = entity.get_attr("friend", data_type=List[Entity], optional=True) or []
        kwargs["friends"] = [friend.get_attr("name") for friend in friends]
        return cls, kwargs

    def execute(self, context):
        names = [perform_substitutions(context, self.who), *self.friends]
        context.log += [f"hello {', '.join(names)}"] * self.times


@expose_action("fast-node")
class FastNode(Node):
    @classmethod
    def parse(cls, entity, parser):
        _, kwargs = super().parse(entity, parser)
        rate = entity.get_attr("rate", data_type=float)
        kwargs["parameters"].append({"rate": rate})
        return cls, kwargs


@expose_action("twice")
def parse_twice(entity, parser):
    return Greet, {"who": parser.parse_substitution("$(shout both)"), "times": 2}


@expose_substitution("shout")
class Shout(Substitution):
    def __init__(self, word):
        self.word = word

    @classmethod
    def parse(cls, data):
        return cls, {"word": data[0]}

    def perform(self, context):
        return perform_substitutions(context, self.word).upper()
"""
SETUP_PY = """
from setuptools import setup

package_name = "greetings"
setup(
    name=package_name,
    packages=[package_name],
    entry_points={"console_scripts": [], "launch.frontend.launch_extension": ["greetings = greetings.tags"]},
)
"""
SETUP_CFG = """
[metadata]
name = greetings
[options.entry_points]
launch.frontend.launch_extension =
    greetings = greetings.tags
"""
XML = '<launch><greet who="$(shout you)" times="2" if="true"><friend name="me"/></greet></launch>'


def package(folder, setup="setup.py", text=SETUP_PY, tags=TAGS):
    greetings = write_package(folder, "greetings")
    write(greetings / setup, text)
    write(greetings / "greetings" / "__init__.py", "")
    write(greetings / "greetings" / "tags.py", tags)
    return greetings


@pytest.mark.parametrize(("setup", "text"), [("setup.py", SETUP_PY), ("setup.cfg", SETUP_CFG)])
def test_a_packages_own_tag_is_used_in_xml(tmp_path, setup, text):
    file = write(package(tmp_path, setup, text) / "launch" / "x.launch.xml", XML)
    assert evaluate(file).log == ("hello YOU, me",) * 2


def test_a_packages_own_tag_is_used_in_yaml(tmp_path):
    text = "launch:\n- greet: {who: $(shout you), times: 2, friend: [{name: me}]}\n- twice:\n"
    file = write(package(tmp_path) / "launch" / "x.launch.yaml", text)
    assert evaluate(file).log == ("hello YOU, me",) * 2 + ("hello BOTH",) * 2


def test_a_tag_of_another_package_of_the_workspace_is_found(tmp_path):
    package(tmp_path / "src" / "deep")
    file = write(write_package(tmp_path / "src", "robots") / "launch" / "x.launch.xml", XML)
    assert len(evaluate(file).log) == 2


def test_a_tag_is_found_in_the_package_folders_that_are_given(tmp_path):
    package(tmp_path / "packages")
    file = write(tmp_path / "loose" / "x.launch.xml", XML)
    assert len(evaluate(file, {}, PackageIndex([tmp_path / "packages"])).log) == 2
    with pytest.raises(InputError, match=r"x.launch.xml:1: <greet>: unknown element"):
        evaluate(file)


def test_a_tag_of_an_installed_package_is_found(tmp_path):
    share = write_package(tmp_path / "share", "greetings")
    site = tmp_path / "lib" / "python3.12" / "site-packages"
    text = "[launch.frontend.launch_extension]\ngreetings = greetings.tags\n"
    write(site / "greetings-0.0.0-py3.12.egg-info" / "entry_points.txt", text)
    write(site / "greetings" / "__init__.py", "")
    write(site / "greetings" / "tags.py", TAGS)
    assert len(evaluate(write(share / "launch" / "x.launch.xml", XML)).log) == 2


def test_a_tag_may_build_on_an_action_of_ros(tmp_path):
    elements = '<fast-node pkg="p" exec="e" rate="5"><param name="x" value="1"/></fast-node>'
    file = write(package(tmp_path) / "launch" / "x.launch.xml", f"<launch>\n{elements}</launch>")
    (node,) = evaluate(file).processes
    assert (node.what, node.parameters, node.place.line) == ("p/e", ({"x": 1}, {"rate": 5.0}), 2)


def test_a_python_launch_file_registers_tags_for_those_it_includes(tmp_path):
    write(tmp_path / "x.launch.xml", XML)
    launched = launch_python(tmp_path, "IncludeLaunchDescription([ThisLaunchFileDir(), '/x.launch.xml'])", TAGS.strip())
    assert len(launched.log) == 2
    with pytest.raises(InputError, match="<greet>: unknown element"):  # in another evaluation
        evaluate(tmp_path / "x.launch.xml")


def test_extensions_leave_no_trace(tmp_path):
    evaluate(write(package(tmp_path) / "launch" / "x.launch.xml", XML))
    assert "greetings" not in sys.modules
    with pytest.raises(InputError, match=r"unknown substitution \$\(shout …\)"):
        launch_xml(tmp_path / "elsewhere", '<log message="$(shout x)"/>')


@pytest.mark.parametrize(
    ("element", "reason"),
    [
        ("<greet/>", "xml:1: <greet>: the attribute 'who' is missing"),
        ('<greet who="x" tims="2"/>', "xml:1: <greet>: unknown attribute 'tims'. Did you mean 'times'"),
        ('<gret who="x"/>', "xml:1: <gret>: unknown element. Did you mean 'greet'"),
        ('<fast_node pkg="p" exec="e" rate="1"><parm/></fast_node>', "<parm>: not an element of <fast_node>"),
    ],
)
def test_a_wrong_use_of_an_own_tag_is_refused(tmp_path, element, reason):
    file = write(package(tmp_path) / "launch" / "x.launch.xml", f"<launch>{element}</launch>")
    with pytest.raises(InputError, match=reason):
        evaluate(file)


def test_an_error_in_a_packages_parse_method_shows_its_lines(tmp_path):
    tags = TAGS.replace('kwargs["who"] =', 'kwargs["who"] = 1 / 0 or')
    file = write(package(tmp_path, tags=tags) / "launch" / "x.launch.xml", XML)
    with pytest.raises(InputError, match=r"x.launch.xml: the launch file's code fails") as error:
        evaluate(file)
    assert "ZeroDivisionError" in str(error.value)
    assert "tags.py" in str(error.value)


def test_an_extension_that_fails_is_named_where_its_tag_is_missing(tmp_path):
    file = write(package(tmp_path, tags="import no_such_module") / "launch" / "x.launch.xml", XML)
    with pytest.raises(
        InputError,
        match=r"unknown element; the launch extension greetings.tags fails \(No module named 'no_such_module'\)",
    ):
        evaluate(file)
    write(file, '<launch><log message="x"/></launch>')
    assert evaluate(file).log == ("x",)


OWN_LOG = """

@expose_action("{name}")
def parse_log(entity, parser):
    return Greet, {{"who": parser.parse_substitution(entity.get_attr("message"))}}
"""


def test_a_packages_own_takes_the_place_of_what_ros_jazzy_lacks_until_the_evaluation_ends(tmp_path):
    elements = '<launch><greet who="you"/><log_info message="all"/></launch>'
    file = write(package(tmp_path / "a", tags=TAGS + OWN_LOG.format(name="log_info")) / "x.launch.xml", elements)
    launched = evaluate(file)
    assert (launched.log, launched.refused_by_ros) == (("hello you", "hello all"), ())
    assert launch_xml(tmp_path / "b", '<log_info message="all"/>').log == ("all",)


def test_a_package_cannot_take_a_tag_of_ros(tmp_path):
    file = write(package(tmp_path, tags=TAGS.replace('"greet"', '"log"')) / "x.launch.xml", XML)
    reason = r"extension greetings.tags fails \(element 'log' is registered by drake_twin\S+\.log and by greetings.tags"
    with pytest.raises(InputError, match=reason):
        evaluate(file)
