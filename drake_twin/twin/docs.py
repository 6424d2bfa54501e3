"""The page of what each thread may use of a twin, generated from the code.

Generate it by ``python -m drake_twin.twin.docs > drake_twin/docs/threads.md``; a test compares the two.
"""

import drake_twin
from drake_twin.twin.owner import Owned, is_for_any_thread, public_members

_INTRODUCTION = """\
# Threads

A twin belongs to one thread: the one that made it, until that hands it over or ends. What reaches the simulation can
be used there only, and raises `ThreadError` in any other thread, at once and by name, also while the twin stands still.
What the table has under *any thread* reads or writes one value, or puts a request into the twin's inbox.

Another thread asks: `twin.inbox.ask(function)` has the twin's own thread call the function at the next step boundary of
an advance or in the next frame of `run`, and returns a future with what it returns or raises.

```python
import threading

from drake_twin import TwinBuilder

twin = TwinBuilder().robot("arm", "package://arduinobot_description/urdf/arduinobot.urdf.xacro").build()
seen = []


def watch():
    seen.append(twin.inbox.ask(lambda: twin.robot_state("arm")).result())
    twin.inbox.ask(lambda: twin.publish("/arm/forward_velocity_controller/commands", [0.5, 0, 0, 0])).result()


watcher = threading.Thread(target=watch)
watcher.start()
while watcher.is_alive():
    twin.advance_to(twin.time + 0.1)
assert seen[0].joints[0] == "joint_1"
```

To run a twin in another thread than the one that made it, hand it over; it belongs to the next thread that uses it.

```python
def run():
    twin.run(until=twin.time + 0.2)
    twin.owner.hand_over()  # a thread that ends needs no hand-over


twin.owner.hand_over()
worker = threading.Thread(target=run)
worker.start()
worker.join()
print(twin.robot_state("arm").positions)
```

Drake's own objects (`twin.diagram`, `plant`, `context`, and systems in them) are had in the twin's own thread only, and
nothing guards them after that: use them there. Plain data that a twin returns (states, messages, findings, snapshots,
plans) may be passed on to any thread. Programs outside of this process use [the ROS 2 graph](ros2.md), and node
programs run in turns with the twin: [nodes](nodes.md).

This page is written by `python -m drake_twin.twin.docs`.

| object | any thread | the twin's own thread |
|---|---|---|
"""


def threads_page() -> str:
    """Return the page as Markdown."""
    for name in drake_twin.__all__:
        getattr(drake_twin, name)  # imports it
    rows = []
    for path, kind in sorted(Owned.PATHS.items(), key=lambda item: (not item[0].startswith("twin"), item[0])):
        free: list[str] = []
        bound: list[str] = []
        for name, member in public_members(kind):
            (free if is_for_any_thread(member) else bound).append(f"`{name}`")
        rows.append(f"| `{path}` | {', '.join(sorted(free))} | {', '.join(sorted(bound))} |\n")
    return _INTRODUCTION + "".join(rows)


if __name__ == "__main__":
    print(threads_page(), end="")
