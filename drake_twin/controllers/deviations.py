"""What controllers and their manager do otherwise than ROS 2 Jazzy on purpose; the rows of a table in the docs."""

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class Deviation:
    """One difference.

    Attributes:
        of: The controllers that it is about.
        behavior: What differs.
        upstream: What ros2_control and ros2_controllers do.
        twin: What the twin does.
        why: The reason.
    """

    of: str
    behavior: str
    upstream: str
    twin: str
    why: str


_SAFER = "a joint must not move without a command of its user"
_SAME_TIME = "simulated time is known exactly"

DEVIATIONS = tuple(
    Deviation(*row)
    for row in (
        (
            "controller manager",
            "`FORCE_AUTO`",
            "`BEST_EFFORT`",
            "also deactivates controllers with conflicting claims",
            "it is what its name promises",
        ),
        (
            "controller manager",
            "a controller of a chain fails",
            "the whole chain is deactivated",
            "it and those that write to it; what it writes to stays active",
            "the lower controllers hold the joints",
        ),
        (
            "controller manager",
            "the topic of a controller in chained mode",
            "is not heard",
            "is not heard once the controller above has written a value",
            "a writer without a command of its own keeps nobody else's from the joints",
        ),
        (
            "controller manager",
            "fallback controllers that cannot be activated",
            "the controllers in their way are deactivated all the same",
            "those stay active",
            _SAFER,
        ),
        ("controller manager", "a switch while paused", "times out on wall time", "acts at the next step", _SAME_TIME),
        (
            "controller manager",
            "parameters that are set while a controller is inactive",
            "count when it is configured next",
            "count at once",
            "it does nothing until it is activated",
        ),
        (
            "controller manager",
            "asynchronous controllers and hardware",
            "threads of their own",
            "all are updated in simulated time, in one thread",
            "a run repeats",
        ),
        (
            "controller manager",
            "hardware plugins",
            "are loaded",
            'each `<ros2_control>` tag means "simulated here", with any plugin',
            "the joints are Drake's",
        ),
        (
            "controller manager",
            "an unclaimed joint",
            "`hold_joints`: a velocity of zero",
            "holds its position",
            "a velocity of zero creeps under a load",
        ),
        (
            "forward controllers",
            "activation after a deactivation in Gazebo",
            "the old velocity resumes",
            "no command until a new one comes",
            _SAFER,
        ),
        ("forward controllers", "time-out", "none", "optional `command_timeout`; 0, the default, is for ever", _SAFER),
        (
            "drives",
            "`max_jerk: 0.0`",
            "the speed never leaves 0",
            "no jerk limit, with a warning",
            "in Humble, no jerk limit applies without `has_jerk_limits`",
        ),
        (
            "forward controllers",
            "a velocity command of zero",
            "the joint creeps under its load",
            "it brakes with its effort limit, then holds its position",
            "a wheel stands on a slope",
        ),
        (
            "position interfaces",
            "servo of gz_ros2_control",
            "velocity = 0.1 · error · update rate",
            "an implicit PD with that lag; it is longer where Drake's solver would not converge",
            "it is stable at any gain, rate and step",
        ),
        (
            "joint_trajectory_controller",
            "time of the written position",
            "t + P, half an update period P early",
            "t + (P + h)/2 with the physics step h, and the mean velocity of the period as feedforward",
            "the joint is on its trajectory in the mean",
        ),
        (
            "joint_trajectory_controller",
            "report of a goal's end",
            "up to a period of `action_monitor_rate` late; a hold begins an update later",
            "at the update at which it is reached or lost",
            _SAME_TIME,
        ),
        (
            "joint_trajectory_controller",
            "a trajectory on the topic during a goal, a goal that runs into `cmd_timeout`",
            "the goal succeeds",
            "it is aborted",
            "its trajectory was not followed to the end",
        ),
        (
            "joint_trajectory_controller",
            "a command of a continuous joint",
            "turns are left to the hardware",
            "it goes the short way",
            "simulated joints count their turns",
        ),
        (
            "joint_trajectory_controller",
            "numbers that are not finite, duplicate joints",
            "are accepted",
            "are refused",
            "they would reach the joints",
        ),
        (
            "drives",
            "the first odometry",
            "after a command or its time-out",
            "from the first update on",
            "a frame tree is whole from the start",
        ),
        (
            "drives",
            "a command stamped in the future",
            "never times out",
            "counts as stamped now",
            "a program that stamps with wall time would never be braked",
        ),
        ("drives", "a command that is not finite", "prolongs the one before it in some drives", "is refused", _SAFER),
        (
            "tricycle_controller",
            "a time-out of zero",
            "every command has timed out",
            "a command is valid for ever",
            "as with the other drives",
        ),
        (
            "drives",
            "frames of several robots",
            "share their names",
            "get the robot's prefix where the file has none",
            "robots are kept apart",
        ),
        (
            "steering controllers",
            "largest steering angle",
            "no parameter",
            "`largest_steering_angle`, `angular_is_steering_angle`",
            "for robots that Gazebo's plugins drive",
        ),
        ("pid_controller", "elements of a message", "in their order", "by their names", "as its documentation says"),
        (
            "pid_controller",
            "service `~/set_feedforward_control`",
            "exists",
            "use the parameter `enable_feedforward`",
            "one way is enough",
        ),
        (
            "gripper controllers",
            "feedback; a goal at a deactivation",
            "none; it stays open",
            "the present state; it is canceled",
            "a client must not wait for ever",
        ),
        (
            "velocity and effort group controllers",
            "deactivation",
            "write zero",
            "write nothing: a joint that no controller claims holds its position",
            "an arm must not fall when a controller ends",
        ),
        (
            "pose_broadcaster",
            "which frames it publishes on `/tf`",
            "any",
            "the robot's root, or a frame that is not a link; `tf.publish_rate` has no effect",
            "a frame has one parent",
        ),
        (
            "gps_sensor_broadcaster",
            "a status that is NaN",
            "cast to an integer",
            "`STATUS_UNKNOWN`",
            "the cast is undefined",
        ),
        (
            "battery_state_broadcaster",
            "the sum of the capacities when it is activated again",
            "forgotten",
            "kept",
            "the batteries are the same",
        ),
        (
            "admittance_controller",
            "a wrench in the axes of `fixed_world_frame`",
            "turned by that link's orientation in the base",
            "by its inverse",
            "gravity is along negative z of a link that is turned, too",
        ),
        (
            "admittance_controller",
            "a reference of the wrong size",
            "cut or filled up",
            "refused",
            "the joints would be others",
        ),
        (
            "admittance_controller",
            "kinematics",
            "a plugin's; with a frame outside the chain the reference is passed on",
            "those of the robot's own plant; the controller is not started, with the reason",
            "a twin that is wrong is worse than none",
        ),
        (
            "gpio_controllers",
            "a command with an unknown name, or an infinite value",
            "written in part; the mock hardware fails",
            "refused as a whole",
            "nobody wants half of a command",
        ),
        (
            "chained_filter_controller",
            "who reads the state interfaces that it exports",
            "any controller",
            "they are listed and on a vector port; filters are of joints' and GPIOs' states",
            "no controller of ros2_controllers reads another one's states",
        ),
        (
            "omni_wheel_drive_controller",
            "`cmd_vel_timeout` of 0",
            "every command is too old",
            "for ever",
            "as in diff_drive_controller",
        ),
        (
            "joint_state_broadcaster",
            "joints of its parameter that have no state interface",
            "left out",
            "in the messages, with NaN",
            "readers see that they have no state",
        ),
        (
            "joint_state_broadcaster",
            "order of the joints",
            "sorted by name",
            "the order of `<ros2_control>`",
            "consumers match by name",
        ),
    )
)
