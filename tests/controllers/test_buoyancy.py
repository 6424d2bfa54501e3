"""gz-sim's Buoyancy on its own: the wrenches of its system, and what a file may say."""

import numpy as np
import pytest
from sdf_worlds import findings, refusal, world_of
from waters import G, box, buoyancy, layers, twin_of

from drake_twin.control.submerged import box_triangles, surface
from drake_twin.controllers.buoyancy import BuoyancyForces
from drake_twin.controllers.world_forces import MovingBody, WorldBodies
from drake_twin.description.plugins.buoyancy import BuoyancyParameters
from drake_twin.description.world_plugins import WORLD_PLUGINS


@pytest.fixture
def system(tmp_path):
    """The system of forces of a world with one box of 0.6×1×0.3 m, half as heavy as water, and its context."""
    twin = twin_of(tmp_path, layers((0.0, 0.0)) + box("box", (0.6, 1.0, 0.3), 500.0, low=0.05))
    found = twin.diagram.GetSubsystemByName("forces/on_links")
    return found, found.CreateDefaultContext()


def wrench(system, context, height, velocity=0.0):
    dut = system[0]
    state = np.array([1.0, 0, 0, 0, 0.2, 0.3, height, 0, 0, 0, 0, 0, velocity])
    dut.GetInputPort("state").FixValue(context, state)
    return dut.GetOutputPort("generalized_forces").Eval(context)


@pytest.mark.parametrize(("height", "volume"), [(-5.0, 0.18), (-0.15, 0.18), (0.0, 0.09), (0.1, 0.03), (0.15, 0.0)])
def test_the_system_outputs_the_weight_of_the_displaced_water(system, height, volume):
    lift = wrench(system, system[1], height)
    assert lift == pytest.approx([0, 0, 0, 0, 0, 1000 * volume * G], abs=1e-9)


def test_the_force_on_a_turned_body_is_upwards_in_the_world(system):
    dut, context = system
    half = np.sqrt(0.5)
    dut.GetInputPort("state").FixValue(context, [half, half, 0, 0, 0, 0, 0.2, *[0.0] * 6])  # y is up
    found = dut.GetOutputPort("generalized_forces").Eval(context)
    assert found == pytest.approx([0, 0, 0, 0, 0, 1000 * 0.6 * 0.3 * 0.3 * G], abs=1e-9)


def test_a_world_without_bodies_has_no_such_system(tmp_path):
    assert not twin_of(tmp_path, buoyancy()).diagram.HasSubsystemNamed("forces/on_links")


def test_the_parameters_are_those_of_the_file(tmp_path):
    body = layers((2.0, 1.0), (-1.0, 900.0), below=1025.0).replace("</plugin>", "<enable>a</enable></plugin>")
    (plugin,) = world_of(tmp_path, body).plugins
    assert plugin.parameters == BuoyancyParameters(1025.0, ((-1.0, 900.0), (2.0, 1.0)), ("a",))
    (plugin,) = world_of(tmp_path, buoyancy("")).plugins
    assert plugin.parameters == BuoyancyParameters(1000.0)
    assert findings(world_of(tmp_path, buoyancy("<depth>3</depth>"))) == ("<depth> of Gazebo plugin buoyancy",)


def test_of_a_worlds_plugins_those_that_publish_exert_no_forces(tmp_path):
    inside = '<input type="gz.msgs.Empty" topic="a"/><output type="gz.msgs.Empty" topic="b"/>'
    trigger = f'<plugin filename="gz-sim-triggered-publisher-system" name="t">{inside}</plugin>'
    world = world_of(tmp_path, buoyancy("") + trigger)
    assert len(world.plugins) == 2
    assert [plugin.parameters for plugin in world.forces] == [BuoyancyParameters(1000.0)]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("<uniform_fluid_density>-1</uniform_fluid_density>", "<uniform_fluid_density> is -1, and has to be zero or"),
        ("<uniform_fluid_density>wet</uniform_fluid_density>", "<uniform_fluid_density> is 'wet', which is not"),
        ("<graded_buoyancy><default_density>inf</default_density></graded_buoyancy>", "default_density> is 'inf'"),
        (
            "<graded_buoyancy><density_change><above_depth>0</above_depth></density_change></graded_buoyancy>",
            "each <density_change> needs one <above_depth> and one <density>",
        ),
    ],
)
def test_values_that_are_refused_with_file_and_line(tmp_path, body, says):
    said = refusal(world_of, tmp_path, f"\n{buoyancy(body)}")
    assert said.startswith(f"{tmp_path / 'test.world'}:5: ")
    assert says in said
    assert "\n" not in said


def test_layers_add_up_to_the_density_at_each_height():
    solid = surface(box_triangles((1.0, 1.0, 1.0)))
    plant = type("Plant", (), {"gravity_field": lambda self: self, "gravity_vector": lambda self: [0, 0, -10]})()
    world = WorldBodies(plant, [MovingBody(None, "a::b", (solid,))])
    forces = BuoyancyForces(BuoyancyParameters(1000.0, ((-0.25, 800.0), (0.25, 2.0)), ()), world)
    motion = type("M", (), {"R_WB": np.eye(3)[None], "origins": np.zeros((1, 3))})()
    (wrench,) = forces.wrenches(motion, np.zeros(0))
    assert wrench[5] == pytest.approx(10 * (0.25 * 1000 + 0.5 * 800 + 0.25 * 2))


def test_a_robot_cannot_have_it(tmp_path):
    robot = f'<model name="r"><link name="l"/>{buoyancy()}</model>'
    twin = twin_of(tmp_path, "", robots={"r": (robot, (0, 0, 0))})
    (said,) = [item.what for item in twin.findings if "buoyancy" in item.what]
    assert said.endswith("(gz-sim-buoyancy-system): it does something in a <world> alone")


def test_the_registry_lists_it_with_its_documentation():
    assert "buoyancy-system" in WORLD_PLUGINS
    assert any("gz-sim-buoyancy-system" in line for line in WORLD_PLUGINS.described())
