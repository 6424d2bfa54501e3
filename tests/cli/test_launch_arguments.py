"""The option --show-args, in the words of ``ros2 launch``."""

import pytest

from drake_twin.cli.launch_arguments import launch_arguments
from drake_twin.cli.options import parser
from drake_twin.errors import InputError


def shown(*words):
    return launch_arguments(parser().parse_args([*map(str, words), "--show-args"]))


def test_the_arguments_of_a_launch_file(tmp_path):
    file = tmp_path / "a.launch.xml"
    inner = tmp_path / "b.launch.xml"
    inner.write_text('<launch><arg name="deep" default="1"/></launch>')
    file.write_text(
        '<launch><arg name="side" default="left" description="which one"/><arg name="must"/>'
        f'<arg name="inner" default="{inner}"/><include file="$(var inner)"/></launch>'
    )
    text = shown(file, "must:=x")
    assert text.startswith("Arguments (pass arguments as '<name>:=<value>'):\n\n    'side':\n        which one\n")
    assert "(default: 'left')" in text
    assert "'deep':" in text


@pytest.mark.parametrize("words", [(), ("robot.urdf",)])
def test_without_a_launch_file_it_is_refused(tmp_path, words):
    with pytest.raises(InputError, match="--show-args needs a launch file"):
        shown(*(tmp_path / word for word in words))
