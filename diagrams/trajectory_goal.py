"""A trajectory controller on the arm: a goal of the action follow_joint_trajectory, its feedback and its result.

Run it: python diagrams/trajectory_goal.py
"""

from drake_twin import TwinBuilder

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
JOINTS = ["joint_1", "joint_2", "joint_3"]

twin = (
    TwinBuilder()
    .robot("arm", ARM, active_controllers=["joint_state_broadcaster"])
    .controller(
        "arm",
        "follower",
        "joint_trajectory_controller/JointTrajectoryController",
        {"joints": JOINTS, "command_interfaces": ["position"], "state_interfaces": ["position", "velocity"]},
    )
    .build()
)

goal = twin.graph.send_goal(
    "/arm/follower/follow_joint_trajectory",
    {
        "trajectory": {
            "joint_names": JOINTS,
            "points": [
                {"positions": [0.5, 0.3, -0.3], "velocities": [0.0] * 3, "time_from_start": {"sec": 1}},
                {"positions": [-0.5, 0.0, 0.0], "velocities": [0.0] * 3, "time_from_start": {"sec": 3}},
            ],
        },
    },
    on_result=lambda ended: print(f"{twin.time:.2f} s: {ended.status}"),
)
while not goal.is_done:
    twin.advance_to(twin.time + 0.5)
    if goal.feedback is not None:
        print(f"{twin.time:.2f} s: position error {abs(goal.feedback.error.positions).max():.1e} rad")

assert goal.status == "succeeded"
assert goal.result.error_code == 0
assert abs(twin.joint_states("arm").position[0] + 0.5) < 1e-2
