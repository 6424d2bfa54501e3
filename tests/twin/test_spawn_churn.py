"""What is spawned and deleted over and over leaves nothing: no object, no descriptor, no thread, nothing on a wire."""

import gc
import os
import threading

from conftest import ROVER, rovers

from drake_twin import Robot
from drake_twin.services.graph import connect
from drake_twin.wires.bag_wire import BagWire


def counts():
    gc.collect()
    return len(gc.get_objects()), len(os.listdir("/proc/self/fd")), threading.active_count()


def test_spawns_and_deletes_leave_nothing(tmp_path):
    with rovers(1).build() as twin:
        seam = connect(twin, [BagWire(tmp_path / "bag")])
        found = []
        for _ in range(4):
            for number in range(5):
                twin.entities.spawn(Robot(f"guest_{number}", ROVER, xyz=(3.0, 0.0, 0.13)))
                twin.advance_to(twin.time + 0.02)
                twin.entities.delete(f"guest_{number}")
                twin.advance_to(twin.time + 0.02)
            seam.flush()
            found.append(counts())
        seam.close()
    (objects, *others), (more, *_) = found[1], found[-1]
    assert more - objects < 10  # ten rounds; one of a robot's thousands for each would be a leak
    assert [item[1:] for item in found[1:]] == [tuple(others)] * 3
