"""Each message of a run has, to the last bit, the numbers of each robot's own ports at the time of its stamp.

The reference evaluates the plain ports of one robot after the other, and calculates one pose after the other, with
arrays: the formulas that publishing began with.
"""

import numpy as np
import pytest
from conftest import ARM, ROVER

from drake_twin import TwinBuilder
from drake_twin.kinematics.joint_frames import JointFrames

TICK = 0.02  # s


def mixed(time_step):
    builder = TwinBuilder(time_step=time_step)
    builder.robot("robot_1", ROVER, xyz=(0, 0, 0.13), rpy=(0.02, -0.01, 0.4))
    builder.robot("arm", ARM, xyz=(3, 0, 0))
    builder.robot("robot_2", ROVER, xyz=(0, 2, 0.13))
    return builder.build()


def port(twin, name):
    return twin.diagram.GetOutputPort(name).Eval(twin.context)


def joint_states(twin, robot):
    """Names, positions, velocities and efforts, by the ports of the robot's model instance."""
    state, efforts = port(twin, f"{robot}/state"), port(twin, f"{robot}/net_actuation")
    layout, plan = twin.built.robots[robot].layout, next(plan for plan in twin.built.plans if plan.name == robot)
    names = [name for name in plan.description.controlled_joints if name in layout.positions]
    rows = (
        [state[layout.positions[name]] for name in names],
        [state[layout.velocities[name]] for name in names],
        [efforts[layout.efforts[name]] if name in layout.efforts else np.nan for name in names],
    )
    return names, *(np.array(row).tobytes() for row in rows)


def transforms(twin):
    """Parent, child, x, y, z, qx, qy, qz, qw of each frame: the bases', then the joints'."""
    found, joints, positions = [], [], []
    for plan in twin.built.plans:
        state, layout = port(twin, f"{plan.name}/state"), twin.built.robots[plan.name].layout
        if layout.base_position is not None:
            pose = state[layout.base_position :][:7].copy()
            pose[:4] /= np.sqrt(pose[:4] @ pose[:4])
            found.append(("world", plan.frame_prefix + plan.model.root_body, *pose[[4, 5, 6, 1, 2, 3, 0]].tolist()))
        joints += [(plan.frame_prefix, joint) for joint in plan.description.movable_joints]
        positions += [state[layout.positions[joint.name]] for joint in plan.description.movable_joints]
    frames, positions = JointFrames([joint for _, joint in joints]), np.array(positions)
    poses = np.hstack([frames.xyz(positions), frames.quaternions(positions)[:, [1, 2, 3, 0]]]).tolist()
    return found + [
        (f"{at}{it.parent}", f"{at}{it.child}", *pose) for (at, it), pose in zip(joints, poses, strict=True)
    ]


def listed(message):
    return [
        (item.header.frame_id, item.child_frame_id, at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w)
        for item in message.transforms
        for at, turn in [(item.transform.translation, item.transform.rotation)]
    ]


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_each_message_has_the_numbers_of_plain_ports_in_the_order_of_the_subscriptions(time_step):
    twin, heard = mixed(time_step), []

    def hear(topic, stamp, of_message, reference):
        def receive(message):
            assert repr(of_message(message)) == repr(reference()), topic  # -0.0 is not 0.0
            heard.append((topic, round(stamp(message).sec * 1000 + stamp(message).nanosec / 1e6, 6)))

        twin.subscribe(topic, receive, 1 / TICK)

    topics = []
    for robot in twin.robots:
        topics.append(f"/{robot}/joint_states")

        def as_bytes(message):
            return list(message.name), *(row.tobytes() for row in (message.position, message.velocity, message.effort))

        hear(topics[-1], lambda message: message.header.stamp, as_bytes, lambda robot=robot: joint_states(twin, robot))
    hear("/tf", lambda message: message.transforms[0].header.stamp, listed, lambda: transforms(twin))
    hear("/clock", lambda message: message.clock, lambda message: None, lambda: None)
    twin.publish("/robot_1/forward_velocity_controller/commands", [3.0, -2.0, 1.0, 5.0])
    twin.publish("/robot_2/forward_velocity_controller/commands", [2.0, 2.0, 2.0, 2.0])
    twin.advance_to(0.3)
    twin.publish("/arm/forward_velocity_controller/commands", [0.5, -0.2, 0.3, 0.1])
    twin.advance_to(0.6)
    expected = [(topic, tick * 20.0) for tick in range(30) for topic in (*topics, "/tf", "/clock")]
    assert heard == expected
