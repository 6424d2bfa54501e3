"""Stand-ins for ``moveit_configs_utils``: they read a MoveIt package's files, so that launch files go on.

``move_group`` is `drake_twin.nodes.programs.move_group`; the other programs are not started.
"""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(__name__, {"moveit_configs_builder": "MoveItConfigs MoveItConfigsBuilder"})
