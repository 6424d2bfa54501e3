"""Parameters of a plant: what has changed since the build, set in another context, and taken back."""

import numpy as np
import pytest
from conftest import ROVER
from pydrake.geometry import ProximityProperties, Role, RoleAssign
from pydrake.multibody.plant import CoulombFriction

from drake_twin.scenario import Robot, Scenario
from drake_twin.twin.physics import Physics
from drake_twin.twin.plant_parameters import PlantParameters


@pytest.fixture(scope="module")
def built():
    return Physics(Scenario((Robot("rover", ROVER),))).built


@pytest.fixture
def root(built):
    return built.diagram.CreateDefaultContext()


@pytest.fixture
def parameters(built, root):
    return PlantParameters(built.plant, built.scene_graph, root)


def mass(built, root, value=None):
    """The mass of the rover's base, after it is set."""
    body = built.plant.GetBodyByName("rover_base_link", built.robots["rover"].instance)
    if value is not None:
        body.SetMass(built.plant.GetMyMutableContextFromRoot(root), value)
    return body.get_mass(built.plant.GetMyContextFromRoot(root))


def test_nothing_has_changed_since_the_build(built, root, parameters):
    assert parameters.changed(root) == {}
    assert parameters.put(root, {}) is False
    mass(built, root, mass(built, root))
    assert parameters.changed(root) == {}


def test_what_has_changed_is_set_in_another_context_and_taken_back(built, root, parameters):
    as_built = mass(built, root)
    mass(built, root, 7.5)
    found = parameters.changed(root)
    assert len(found) == 1
    other = built.diagram.CreateDefaultContext()
    assert parameters.put(other, found) is True
    assert mass(built, other) == 7.5
    assert parameters.changed(other) == found
    assert parameters.put(other, {}) is True
    assert mass(built, other) == as_built
    assert parameters.changed(other) == {}


def test_what_is_unknown_or_not_finite_is_refused(built, root, parameters):
    with pytest.raises(ValueError, match="does not have the parameters what of whom"):
        parameters.put(root, {"what of whom": [1.0]})
    assert parameters.put(root, {"what of whom": [1.0]}, leave_out_unknown=True)
    mass(built, root, 7.5)
    (name,) = parameters.changed(root)
    with pytest.raises(ValueError, match="not finite"):
        parameters.put(root, {name: [np.nan] * 10})
    assert mass(built, root) == 7.5


def test_a_shapes_friction_is_read_again_when_it_has_been_set_and_when_it_is_taken_back(built, root, parameters):
    scene_graph = built.scene_graph
    context = scene_graph.GetMyMutableContextFromRoot(root)
    inspector = scene_graph.get_query_output_port().Eval(context).inspector()
    shape = next(
        each
        for each in inspector.GetAllGeometryIds(Role.kProximity)
        if built.plant.GetBodyFromFrameId(inspector.GetFrameId(each)).name() == "rover_base_link"
    )

    def set_friction(value):
        properties = ProximityProperties(inspector.GetProximityProperties(shape))
        properties.UpdateProperty("material", "coulomb_friction", CoulombFriction(value, value))
        scene_graph.AssignRole(context, built.plant.get_source_id(), shape, properties, RoleAssign.kReplace)

    before = inspector.GetProximityProperties(shape).GetProperty("material", "coulomb_friction").static_friction()
    assert parameters.changed(root) == {}
    for value in (0.25, 0.125):
        set_friction(value)
        assert list(parameters.changed(root).values()) == [[value, value]]
    assert parameters.changed(built.diagram.CreateDefaultContext()) == {}
    assert list(parameters.changed(root).values()) == [[0.125, 0.125]]
    set_friction(before)
    assert parameters.changed(root) == {}
