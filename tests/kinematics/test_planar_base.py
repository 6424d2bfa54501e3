import numpy as np
import pytest

from drake_twin.description.robot_description import Pose
from drake_twin.kinematics.planar_base import PlanarBase
from drake_twin.kinematics.state_layout import StateLayout

# The state of another joint, then the slides x, y, z and the turn; their velocities likewise.
START = Pose((1.0, 2.0, 3.0), (0.0, 0.0, np.pi / 2))
LAYOUT = StateLayout(10, {}, {}, {}, planar_base=PlanarBase(START, (1, 2, 3, 4), (6, 7, 8, 9)))


def test_at_zero_the_base_is_where_it_was_spawned():
    pose, velocity = LAYOUT.base_state(np.zeros(10))
    assert pose == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5), 1, 2, 3])
    assert velocity.tolist() == [0] * 6


def test_the_slides_are_along_the_axes_of_the_start():
    pose, velocity = LAYOUT.base_state(np.array([9, 0.1, 0.2, 0.3, np.pi / 2, 9, 0.4, 0.5, 0.6, 0.7]))
    assert pose == pytest.approx([0, 0, 0, 1, 1 - 0.2, 2 + 0.1, 3.3], abs=1e-12)
    assert velocity == pytest.approx([0, 0, 0.7, -0.5, 0.4, 0.6])


def test_a_floating_bases_quaternion_has_length_one():
    layout = StateLayout(13, {}, {}, {}, base_position=0, base_velocity=7)
    state = np.array([3.0, 0, 0, 4.0, 1, 2, 3, 4, 5, 6, 7, 8, 9])
    pose, velocity = layout.base_state(state)
    assert pose == pytest.approx([0.6, 0, 0, 0.8, 1, 2, 3])
    assert velocity.tolist() == [4, 5, 6, 7, 8, 9]
    assert state[0] == 3.0


def test_a_base_that_does_not_move_has_no_state():
    with pytest.raises(ValueError, match="does not move"):
        StateLayout(0, {}, {}, {}).base_state(np.zeros(0))
