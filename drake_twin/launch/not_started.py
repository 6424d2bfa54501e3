"""Why a node of a launch file is not started."""

from drake_twin.ros_launch.launched import LaunchedProcess

# Part of "package/executable" → the reason; the first that fits.
_REASONS = (
    ("rviz", "the page shows the robots"),
    ("plotjuggler", "the page shows the robots"),
    ("rqt", "it is a window of ROS"),
    ("joint_state_publisher", "joint states come from the simulation"),
    ("teleop", "publish commands with --pub or on the page"),
    ("joy", "it reads a device"),
    ("nav2", "navigation is another program's work"),
    ("amcl", "navigation is another program's work"),
    ("map_server", "navigation is another program's work"),
    ("slam", "mapping is another program's work"),
    ("cartographer", "mapping is another program's work"),
    ("rtabmap", "mapping is another program's work"),
    ("moveit", "motion planning is another program's work"),
    ("move_group", "motion planning is another program's work"),
    ("robot_localization", "localization is another program's work"),
    ("ekf", "localization is another program's work"),
    ("image", "the twin has no cameras"),
    ("depth", "the twin has no cameras"),
    ("laser", "the twin has no lidar"),
    ("pointcloud", "the twin has no lidar"),
    ("twist_mux", "the twin has one commander for each topic"),
    ("twist_stamper", "the twin takes both kinds of twists"),
    ("gz", "it belongs to Gazebo's window or services"),
    ("gazebo", "it belongs to Gazebo's window or services"),
)


def why_not_started(process: LaunchedProcess) -> str:
    """``PACKAGE/EXECUTABLE (why)`` for something that a launch file starts and the twin does not."""
    what = process.what
    reason = next((reason for part, reason in _REASONS if part in what.lower()), None)
    if reason is None:
        reason = "the twin runs no programs" if process.package is None else "the twin has no such node"
    return f"{what} ({reason})"
