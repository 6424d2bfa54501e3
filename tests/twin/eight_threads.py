"""A program: eight threads use every public member of a twin while it runs, spawns, deletes and resets.

``eight_threads.py ROUNDS OTHERS`` prints the hashes of the rounds, and ends with 1 if a member did what it should not.
"""

import sys
import threading

import drake_twin
from drake_twin import Robot, ThreadError, TwinBuilder, show
from drake_twin.twin.event_topics import ROSOUT
from drake_twin.twin.owner import Owned, is_for_any_thread, public_members

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
JOINTS = ["joint_1", "joint_2", "joint_3"]
FOLLOWER = "joint_trajectory_controller/JointTrajectoryController"
INTERFACES = {"command_interfaces": ["position"], "state_interfaces": ["position", "velocity"]}
ACTION = "/arm/follower/follow_joint_trajectory"
POINT = {"positions": [0.1, 0.1, 0.1], "time_from_start": {"sec": 100}}
GOAL = {"trajectory": {"joint_names": JOINTS, "points": [POINT]}}
WHEELS = "/rover/forward_velocity_controller/commands"
ROBOTS = (("rover", "arm"), ("rover", "arm", "other"))


def build():
    return (
        TwinBuilder(time_step=0.002)
        .robot("rover", ROVER, xyz=(0, 0, 0.13), xacro_args={"lidar": "true"})
        .robot("arm", ARM, xyz=(5, 0, 0), active_controllers=["joint_state_broadcaster"])
        .controller("arm", "follower", FOLLOWER, {"joints": JOINTS, **INTERFACES})
        .build()
    )


def objects(twin, goal):
    """What a twin is and hands out, by how a user writes it."""
    names = ("alarm", "clock", "control", "entities", "graph", "inbox", "recorder")
    page = show(twin)
    panel = page.panel("mine")
    return {
        "twin": twin,
        "twin.control.manager(…)": twin.control.manager("arm"),
        "twin.graph.events[…]": twin.graph.events[ROSOUT],
        "twin.sensor(…)": twin.sensor("rover", "lidar"),
        "goal": goal,
        "page": page,
        "panel": panel,
        "control": panel.checkbox("on"),
        "marker": panel.marker("here", (0, 0, 0)),
        "rewind": drake_twin.Rewind(twin),
        **{f"twin.{name}": getattr(twin, name) for name in names},
    }


def wrong(path, each, name, member, twin):
    """Use a member in a thread that the twin does not belong to; return what is wrong, or None."""
    try:
        if isinstance(member, property):
            value = getattr(each, name)
            if member.fset is not None:
                setattr(each, name, value)
        elif path == "twin.inbox" and name == "ask":
            value = each.ask(lambda: (twin.robots, twin.robot_state("rover").joints)).result()
        elif path == "twin.inbox" and name == "put":
            value = each.put(lambda: None)
        elif path == "twin.graph.events[…]" and name == "put":
            value = each.put(dict)
        else:
            value = getattr(each, name)()
    except ThreadError as error:
        named = f"{path}.{name}" in str(error) and "'MainThread'" in str(error) and "'stranger" in str(error)
        return f"refuses: {error}" if is_for_any_thread(member) or not named else None
    if not is_for_any_thread(member):
        return f"is not refused: {value}"
    return None if plausible(f"{path}.{name}", value) else f"is {value!r}"


def plausible(where, value):
    """Whether a value is one of those that the twin has at its boundaries."""
    match where:
        case "twin.time":
            return 0 <= value <= 0.3 and min(abs(value / step - round(value / step)) for step in (0.002, 0.003)) < 1e-6
        case "twin.clock.time_step":
            return value in (0.002, 0.003)
        case "twin.robots":
            return value in ROBOTS
        case "twin.inbox.ask":
            return value[0] in ROBOTS and len(value[1]) > 3
    return True


def strangers(twin, goal, faults):
    """Start eight threads; return a function that ends them and returns how many members each has used."""
    things, is_over, counts = objects(twin, goal), threading.Event(), []
    assert things.keys() == Owned.PATHS.keys()

    def use():
        used = 0
        while not is_over.is_set():
            for path, each in things.items():
                for name, member in public_members(Owned.PATHS[path]):
                    fault = wrong(path, each, name, member, twin)
                    used += 1
                    if fault is not None:
                        faults.append(f"{path}.{name} {fault}")
                        return
        counts.append(used)

    threads = [threading.Thread(target=use, name=f"stranger {index}") for index in range(8)]
    for thread in threads:
        thread.start()

    def end():
        is_over.set()
        while any(thread.is_alive() for thread in threads):
            twin.play()
            twin.step()  # what they have asked is answered
        things["page"].close()
        things["rewind"].close()
        return counts

    return end


def advance(twin, time):
    while twin.time < time - 1e-9:  # others pause it
        twin.play()
        twin.advance_to(time)


def use(twin):
    """Use a twin as its own thread; return its hashes."""
    found = []
    twin.reset()
    twin.publish(WHEELS, [2.0, 3.0, 2.0, 3.0])
    advance(twin, 0.06)
    twin.entities.spawn(Robot("other", ROVER, xyz=(0, 3, 0.13)))
    advance(twin, 0.12)
    found.append(twin.state_sha256())
    twin.clock.set_time_step(0.003)
    moment = twin.snapshot()
    twin.entities.apply_wrench("other", force=(50, 0, 0), duration=0.05)
    advance(twin, 0.18)
    twin.entities.delete("other")
    found.append(twin.state_sha256())
    twin.restore(moment)
    advance(twin, 0.24)
    twin.clock.set_time_step(0.002)
    twin.entities.delete("other")
    advance(twin, 0.3)
    return [*found, twin.state_sha256()]


def main(rounds, others):
    sys.setswitchinterval(1e-5)  # s: Python gives each thread its turn so much more often than by default
    twin, faults = build(), []
    goal = twin.graph.send_goal(ACTION, GOAL)
    end = strangers(twin, goal, faults) if others else list
    hashes = []
    for _ in range(rounds):
        for item in use(twin):
            if item not in hashes:
                hashes.append(item)
    counts = end()
    print(*hashes)
    print(*faults, *counts, sep="\n", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2] == "yes"))
