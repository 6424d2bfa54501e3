"""gz-sim's ApplyLinkWrench in a world file as plain data."""

import pytest
from sdf_worlds import world_of

from drake_twin.description.world_wrenches import LinkWrench

PLUGIN = '<plugin filename="{file}" name="gz::sim::systems::ApplyLinkWrench">{elements}</plugin>'
NONE = (0.0, 0.0, 0.0)


def systems(tmp_path, *elements, file="gz-sim-apply-link-wrench-system"):
    world = world_of(tmp_path, "".join(PLUGIN.format(file=file, elements=item) for item in elements))
    return world.wrench_systems, world.findings


def persistent(entity="box", kind="model", more=""):
    return f"<persistent><entity_name>{entity}</entity_name><entity_type>{kind}</entity_type>{more}</persistent>"


@pytest.mark.parametrize("file", ["gz-sim-apply-link-wrench-system", "libignition-gazebo6-apply-link-wrench-system.so"])
def test_forces_and_topics_of_a_plugin(tmp_path, file):
    vectors = "<force>-10 0 0.5</force><torque>0 0\n0.1</torque>"
    (system,), findings = systems(
        tmp_path, persistent(more=vectors) + persistent("arm::tip", "link", "<force/>"), file=file
    )
    assert system.persistent == (
        LinkWrench("box", (-10.0, 0.0, 0.5), (0.0, 0.0, 0.1)),
        LinkWrench("arm::tip", NONE, NONE),
    )
    names = ["/world/w/wrench", "/world/w/wrench/persistent", "/world/w/wrench/clear"]
    assert [system.topic, system.topic_persistent, system.topic_clear] == names
    assert findings == ()


def test_topics_that_the_file_gives(tmp_path):
    given = "<topic>a/b</topic><topic_persistent>/c/</topic_persistent><topic_clear/><verbose>false</verbose>"
    found, findings = systems(tmp_path, given, "")
    assert [item.topic for item in found] == ["/a/b", "/world/w/wrench"]
    assert (found[0].topic_persistent, found[0].topic_clear) == ("/c", "/world/w/wrench/clear")
    assert findings == ()


@pytest.mark.parametrize(
    ("element", "what"),
    [
        ("<persistent><entity_type>link</entity_type></persistent>", "<persistent> needs an <entity_name>"),
        (persistent(kind="joint"), "<entity_type> is 'joint'"),
        (persistent(more="<force>1 2</force>"), "three numbers are needed"),
        (persistent(more="<torque>1 2 inf</torque>"), "torque is 'inf', which is not finite"),
    ],
)
def test_one_that_cannot_be_is_left_out_with_its_place(tmp_path, element, what):
    (system,), (finding,) = systems(tmp_path, element + persistent("egg"))
    assert [item.entity for item in system.persistent] == ["egg"]
    assert what in finding.what
    assert (finding.file, len(finding.lines)) == (str(tmp_path / "test.world"), 1)


def test_a_world_without_it_has_none(tmp_path):
    assert world_of(tmp_path, "").wrench_systems == ()
