"""Lesson 1, first half: the digital twin of an arm, without `<ros2_control>` and with it.

Run it: python diagrams/arm_that_bends.py

Without <ros2_control> nothing drives the joints, so the arm bends under its own weight. With it the joints have
actuators: they hold their start position until a controller commands them.
"""

from drake_twin import TwinBuilder

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"


def bent_by(twin):
    """Return how far each joint of the arm is from zero after three seconds (rad)."""
    twin.advance_to(3.0)
    state = twin.robot_state("arm")
    return {joint: abs(position) for joint, position in zip(state.joints[:3], state.positions, strict=False)}


limp = TwinBuilder().robot("arm", ARM, xacro_args={"use_ros2_control": False}).build()
held = TwinBuilder().robot("arm", ARM).build()
driven = TwinBuilder().robot("arm", ARM).build()
driven.publish("/arm/forward_velocity_controller/commands", [0.5, 0.25, -0.25, 0.0])  # rad/s, in YAML order

found = {
    "no <ros2_control>": bent_by(limp),
    "no command": bent_by(held),
    "a velocity command": bent_by(driven),
}
for case, joints in found.items():
    print(f"{case:20}", "  ".join(f"{joint} {angle:6.3f} rad" for joint, angle in joints.items()))

assert found["no <ros2_control>"]["joint_3"] > 0.5
assert max(found["no command"].values()) < 1e-3
assert abs(found["a velocity command"]["joint_1"] - 1.5) < 0.02
