"""What of a world nobody uses, but is wrong: it is said once, with its line."""

import pytest
from sdf_worlds import BOX, world_of

STATE = """<model name="box"><pose>5 0 0 0 0 0</pose>{}</model>
<state world_name="w"><model name="box">{}<link name="link"><pose>1 2 3 0 0 0</pose></link></model></state>"""


def said(world):
    return [(finding.what, finding.lines) for finding in world.findings]


@pytest.mark.parametrize("own", ["", "<pose>5 0 0 0 0 0</pose>"])
def test_a_state_of_links_alone_is_not_used_and_said(tmp_path, own):
    world = world_of(tmp_path, STATE.format(BOX, own))
    assert world.models[0].pose.xyz == (5, 0, 0)
    what = "the poses of the links of box in <state>: it starts where its own pose is"
    assert said(world) == ([] if own else [(what, (5,))])


@pytest.mark.parametrize(
    ("frames", "what"),
    [
        ('<frame name="a"><pose relative_to="b"/></frame><frame name="b"><pose relative_to="a"/></frame>', "'a'"),
        ('<frame name="a" attached_to="b"/><frame name="b" attached_to="a"/>', "'a'"),
        ('<frame name="a"><pose relative_to="a"/></frame>', "'a'"),
    ],
)
def test_frames_that_hold_each_other_are_said_where_nobody_uses_them_too(tmp_path, frames, what):
    ((text, lines),) = said(world_of(tmp_path, f'<model name="box">{BOX}</model>\n{frames}'))
    assert text.endswith(f"its pose is relative to {what}, which is relative to it")
    assert lines == (5,)


def test_a_plugin_whose_name_is_misspelt_is_said_once(tmp_path):
    plugin = '<plugin filename="gz-sim-fisics-system" name="gz::sim::systems::Physics"/>'
    ((text, lines),) = said(world_of(tmp_path, plugin))
    assert "one of the two names is misspelt" in text
    assert lines == (4,)
