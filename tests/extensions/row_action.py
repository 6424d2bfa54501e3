"""A launch action of somebody else's, in one file, as one writes it for ROS: a row of robots."""

from launch import Action
from launch.frontend import expose_action
from launch.utilities import perform_substitutions
from launch_ros.actions import Node


@expose_action("row")
class Row(Action):
    """``<row file="FILE" count="3" gap="2.0"/>``: robots along x, so far apart (m)."""

    def __init__(self, *, file, count, gap, **kwargs):
        super().__init__(**kwargs)
        self.file, self.count, self.gap = file, count, gap

    @classmethod
    def parse(cls, entity, parser):
        _, kwargs = super().parse(entity, parser)
        kwargs["file"] = parser.parse_substitution(entity.get_attr("file"))
        kwargs["count"] = entity.get_attr("count", data_type=int)
        kwargs["gap"] = entity.get_attr("gap", data_type=float)
        return cls, kwargs

    def execute(self, context):
        file = perform_substitutions(context, self.file)
        for index in range(self.count):
            place = ["-name", f"stone_{index}", "-file", file, "-x", str(self.gap * index), "-z", "50"]
            yield Node(package="ros_gz_sim", executable="create", arguments=place)
