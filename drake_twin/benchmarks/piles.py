"""Loose boxes without robots: towers, boxes at rest, heaps."""

import numpy as np

from drake_twin.benchmarks.boxes import Box
from drake_twin.benchmarks.workloads import Workload

_CUBE, _BRICK = (0.2, 0.2, 0.2), (0.2, 0.15, 0.1)  # m
_TOWER, _HEAP = 10, 20  # boxes of one tower, of one heap


def _towers(count: int) -> tuple[Box, ...]:
    return tuple(
        Box(_CUBE, (float(tower // 8), float(tower % 8), 0.1 + 0.2 * index), mass=2.0)
        for tower in range(count)
        for index in range(_TOWER)
    )


def _at_rest(count: int) -> tuple[Box, ...]:
    return tuple(Box(_CUBE, (float(index % 6), float(index // 6), 0.1), mass=2.0) for index in range(count))


def _heaps(count: int) -> tuple[Box, ...]:
    """Return boxes that fall onto heaps, of twenty each, from 0.15 to 3.4 m."""
    random = np.random.default_rng(1)
    boxes = []
    for index in range(count):
        heap, level = divmod(index, _HEAP)
        roll, pitch, yaw = random.uniform(-1, 1, 3).tolist()
        x, y = random.uniform(-0.15, 0.15, 2).tolist()
        boxes.append(Box(_BRICK, (x, y + 3.0 * heap, 0.15 + 0.17 * level), (roll, pitch, yaw), mass=1.0))
    return tuple(boxes)


PILES = {
    workload.name: workload
    for workload in (
        Workload("towers of ten boxes", pile=_towers, friction=0.8),
        Workload("boxes at rest", pile=_at_rest, friction=0.8),
        Workload("boxes in heaps of twenty", pile=_heaps, friction=0.6, timed_from=1.0),
    )
}
