import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder

from drake_twin.systems.plant_reading import PlantPorts, Reading


@pytest.fixture
def reading():
    """A pendulum with a motor of 3 N·m, 2.5 s after the start."""
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(time_step=0.0))
    body = plant.AddRigidBody("bob", SpatialInertia(1.0, [0, 0, 0], UnitInertia(1, 1, 1)))
    joint = plant.AddJoint(RevoluteJoint("j", plant.world_frame(), body.body_frame(), [0, 0, 1]))
    plant.AddJointActuator("motor", joint)
    plant.Finalize()
    context = builder.Build().CreateDefaultContext()
    context.SetTime(2.5)
    own = plant.GetMyMutableContextFromRoot(context)
    plant.SetPositionsAndVelocities(own, [0.4, -0.7])
    plant.get_actuation_input_port().FixValue(own, [3.0])
    return Reading(PlantPorts(plant), context, own)


def test_the_state_the_efforts_nan_and_zero_follow_each_other(reading):
    assert (reading.time, reading.state.tolist()) == (2.5, [0.4, -0.7])
    np.testing.assert_array_equal(reading.with_efforts, [0.4, -0.7, 3.0, np.nan, 0.0])


def test_efforts_that_are_not_asked_for_are_nan_at_the_same_places(reading):
    np.testing.assert_array_equal(reading.without_efforts, [0.4, -0.7, np.nan, np.nan, 0.0])


def test_what_was_read_stays_when_the_context_moves_on(reading):
    assert reading.state.tolist() == [0.4, -0.7]
    context = reading.root_context
    context.SetTime(3.0)
    context.SetContinuousState([9.0, 9.0])
    assert (reading.time, reading.state.tolist()) == (2.5, [0.4, -0.7])
