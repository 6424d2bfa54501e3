import shutil
import subprocess
import sys

import pytest
from conftest import rovers

from drake_twin import Twin
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.description.package_index import share_folder
from drake_twin.diagram.picture import dot_text, write_picture
from drake_twin.errors import InputError
from drake_twin.scenario.scenario_file import ScenarioFile

needs_graphviz = pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz's program dot is not installed")


def test_the_text_is_the_same_however_many_diagrams_were_made_before():
    assert dot_text(rovers().build().diagram) == dot_text(rovers().build().diagram)


def test_the_text_shows_robots_systems_and_topics():
    text = dot_text(rovers().build().diagram)
    for name in (
        "name=robot_1",
        "ForwardCommandController",
        "robot_2/forward_velocity_controller/commands",
        "name=plant",
    ):
        assert name in text
    assert "0x" not in text


@needs_graphviz
def test_an_svg_carries_the_text_it_was_drawn_from(tmp_path):
    diagram = rovers(1).build().diagram
    write_picture(diagram, tmp_path / "d.svg")
    assert f"<metadata><![CDATA[{dot_text(diagram)}]]></metadata>" in (tmp_path / "d.svg").read_text()


def test_an_svg_without_graphviz_is_refused_with_what_helps(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"needs Graphviz's program 'dot'.*apt install.*d\.dot can be written"):
        write_picture(rovers(1).build().diagram, tmp_path / "d.svg")


def test_another_suffix_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"written as \.dot or \.svg, not '\.png'"):
        write_picture(rovers(1).build().diagram, tmp_path / "d.png")


READY_MADE = sorted({*share_folder("diagrams").glob("*.yaml"), *share_folder("diagrams").glob("*.launch.*")})


@pytest.mark.one_plant
@pytest.mark.parametrize("file", READY_MADE, ids=lambda file: file.name)
def test_the_pictures_in_diagrams_are_up_to_date(file):
    """Draw them anew with: python -m drake_twin.run diagrams/FILE --graphviz diagrams/NAME.svg"""
    picture = file.with_name(f"{file.name.partition('.')[0]}.svg").read_text()
    is_scenario = ".launch." not in file.name
    scenario = ScenarioFile.read(file).scenario if is_scenario else launch_file_scenario(file).scenario
    assert f"<metadata><![CDATA[{dot_text(Twin(scenario).diagram)}]]></metadata>" in picture


def test_there_are_ready_made_twins():
    names = {file.name for file in READY_MADE}
    assert {"two_rovers.yaml", "rovers_in_formation.launch.py", "rover_and_arm.launch.xml"} <= names


def test_another_process_draws_the_same_text(tmp_path):
    command = [sys.executable, "-m", "drake_twin.run", "--robots", "2", "--graphviz", str(tmp_path / "d.dot")]
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "d.dot").read_text() == dot_text(_demo().diagram)


def _demo():
    from drake_twin.builder.demo import demo_scenario

    return Twin(demo_scenario("rover", 2))
