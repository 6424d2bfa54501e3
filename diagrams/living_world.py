"""A world that changes while it runs: spawn, push, delete, return to a snapshot, replay a recording.

Run it: python diagrams/living_world.py
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from drake_twin import Recording, Robot, TwinBuilder, replay

ROVER = "package://rover_description/urdf/rover.urdf.xacro"

twin = TwinBuilder().robot("robot_1", ROVER, xyz=(0, 0, 0.13)).build()
twin.recorder.begin()
twin.publish("/robot_1/forward_velocity_controller/commands", [3.0, 3.0, 3.0, 3.0])
twin.advance_to(1.0)

twin.entities.spawn(Robot("robot_2", ROVER, xyz=(0, 2, 0.13)))  # robot_1 continues, with the same bits as without it
twin.entities.apply_wrench("robot_2", force=(0, 250, 0), duration=0.5)
twin.advance_to(2.0)
print("robots:", *twin.robots)
print(f"robot_2 was pushed to y {twin.entities.state('robot_2').position[1]:.3f} m")

here = twin.snapshot()
twin.entities.delete("robot_2")
twin.advance_to(3.0)
assert twin.robots == ("robot_1",)

with TemporaryDirectory() as folder:
    file = Path(folder) / "run.json"
    twin.recorder.recording().save(file)
    again = replay(Recording.load(file))
print(f"replayed to {again.time} s: the same state is {again.state_sha256() == twin.state_sha256()}")
assert again.state_sha256() == twin.state_sha256()

twin.restore(here)
print(f"back at {twin.time} s with", *twin.robots)
assert (twin.time, twin.robots) == (2.0, ("robot_1", "robot_2"))
