"""The nodes of a Create 3, which need the messages of ``irobot_create_msgs`` from the workspace."""

from importlib import import_module

from drake_twin.nodes.task import present_task

_MESSAGES = "irobot_create_msgs"


def motion_control() -> None:
    """Run ``motion_control``."""
    _run("create3_motion_control", "the actions dock, undock and wall_follow, and reflexes, are not there")


def ui_mgr() -> None:
    """Run ``ui_mgr``."""
    _run("create3_ui_mgr")


def _run(module: str, missing: str = "") -> None:
    try:
        program = import_module(module)
    except ModuleNotFoundError as error:
        if error.name != _MESSAGES:
            raise
        present_task().program.ignored(f"it does nothing, as the package {_MESSAGES} is not in the workspace")
        return
    if missing:
        present_task().program.ignored(missing)
    program.main()
