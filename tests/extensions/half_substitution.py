"""A substitution of somebody else's, in one file, as one writes it for ROS: half of a number."""

from launch import Substitution
from launch.frontend import expose_substitution
from launch.utilities import perform_substitutions


@expose_substitution("half")
class Half(Substitution):
    """``$(half NUMBER)``."""

    def __init__(self, number):
        super().__init__()
        self.number = number

    @classmethod
    def parse(cls, data):
        return cls, {"number": data[0]}

    def perform(self, context):
        return str(float(perform_substitutions(context, self.number)) / 2)
