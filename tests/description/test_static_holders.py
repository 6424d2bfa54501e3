"""Static models of a world whose DetachableJoint holds other models."""

import pytest
from sdf_worlds import BOX, world_of

from drake_twin.cli.options import parser
from drake_twin.cli.target import find_target
from drake_twin.twin.twin import Twin

HOLDS = """<plugin filename="gz-sim-detachable-joint-system" name="gz::sim::systems::DetachableJoint">
<parent_link>link</parent_link><child_model>crate</child_model><child_link>link</child_link>
<detach_topic>/crate/detach</detach_topic></plugin>"""
TELLS = """<plugin filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher">
<input type="gz.msgs.Empty" topic="/start"/><output type="gz.msgs.Empty" topic="/crate/detach"/></plugin>"""
CRATE = f'<model name="crate"><pose>0 0 5 0 0 0</pose>{BOX}</model>'


def hook(plugins):
    return f'<model name="hook"><static>true</static><pose>0 0 9 0 0 0</pose>{BOX}{plugins}</model>'


@pytest.fixture
def height(tmp_path):
    """A twin of a world as the command line runs it, and where its crate is (m)."""

    def build(*models):
        file = tmp_path / "held.sdf"
        file.write_text(f'<sdf version="1.9"><world name="w">{"".join(models)}</world></sdf>')
        twin = Twin(find_target(parser().parse_args([str(file)])).scenario)
        return twin, lambda: twin.entities.state("crate").position[2]

    return build


def test_it_holds_a_model_until_a_message_lets_it_go(height):
    twin, found = height(hook(HOLDS), CRATE)
    twin.advance_to(1.0)
    assert found() == pytest.approx(5.0, abs=1e-6)
    twin.publish("/hook/crate/detach", {})
    twin.advance_to(1.5)
    assert found() == pytest.approx(5 - 9.8 * 0.5**2 / 2, abs=0.02)


def test_what_it_publishes_is_published_once(height, tmp_path):
    world = world_of(tmp_path, hook(HOLDS + TELLS))
    assert world.plugins == ()  # its robot has it
    assert world.models[0].robot is not None
    twin, found = height(hook(HOLDS + TELLS), CRATE)
    assert len(twin.built.triggers) == 1
    twin.advance_to(0.5)
    assert found() == pytest.approx(5.0, abs=1e-6)


def test_a_static_model_without_one_is_no_robot(tmp_path):
    world = world_of(tmp_path, hook(HOLDS.replace("detachable-joint", "pose-publisher")) + hook(TELLS))
    assert [model.robot for model in world.models] == [None, None]
    assert len(world.plugins) == 1
