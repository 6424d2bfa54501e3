"""What ``mypy`` has to find in a user's program; the comment of a line is the code of its error."""

from drake_twin import NoSuchName, Scenario, Twin, TwinBuilder  # attr-defined
from drake_twin.controllers import NoSuchBase  # attr-defined
from drake_twin.twin import NoSuchPart  # attr-defined

TwinBuilder(time_step="1 ms")  # arg-type
TwinBuilder().robot("robot_1")  # call-arg
TwinBuilder().build().advance_too(1.0)  # attr-defined
Twin(Scenario(robots=("robot_1",)))  # arg-type
NAME: str = Twin(Scenario(robots=())).robot_state("robot_1")  # assignment
print(NoSuchName, NoSuchBase, NoSuchPart)
