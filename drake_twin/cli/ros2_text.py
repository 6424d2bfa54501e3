"""Topics and controllers of a twin, as ROS 2's command line tools print them."""

from drake_twin.twin.twin import Twin


def topics_text(twin: Twin) -> str:
    """Return what ``ros2 topic list -t`` prints, followed by the actions."""
    lines = [f"{topic} [{kind}]" for topic, kind in sorted(twin.graph.topics().items())]
    lines += [f"{action} [{kind}] (action)" for action, kind in sorted(twin.graph.actions().items())]
    return "\n".join(lines)


def controllers_text(twin: Twin) -> str:
    """Return what ``ros2 control list_controllers`` prints, for each controller manager."""
    lines = []
    for plan in twin.built.plans:
        states = twin.control.manager(plan.name).list_controllers()
        lines.append(f"{plan.robot.topic_namespace}/controller_manager:")
        if not states:
            lines.append("  No controllers are currently loaded!")
        names = max((len(item.name) for item in states), default=0)
        types = max((len(item.type) for item in states), default=0)
        lines += [f"  {item.name:<{names}} {item.type:<{types}} {item.state}" for item in states]
    return "\n".join(lines)
