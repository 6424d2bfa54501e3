"""Services of somebody else's, in one file: one of the twin, and one of each robot."""

from drake_twin.services.registry import robot_service, twin_service


@twin_service("std_srvs/srv/Trigger", "/highest_robot")
def highest_robot(twin, request):
    heights = {plan.name: twin.robot_state(plan.name).base_pose[2] for plan in twin.built.plans}
    return {"success": True, "message": max(heights, key=heights.get)}


@robot_service("std_srvs/srv/Trigger", "height", "altimeter")
def height(twin, robot, request):
    return {"success": True, "message": f"{twin.robot_state(robot).base_pose[2]:.0f}"}
