"""How many objects of a kind are alive, for tests of what a twin leaves behind."""

import gc


def living(*kinds: type) -> list[int]:
    """Count the living instances of each kind, once nothing more can be collected.

    One collection is not enough: what a Drake object owns is freed with it, and only then are the Python objects that
    it referred to found unreachable.
    """
    counts: list[int] = []
    while True:
        gc.collect()
        objects = gc.get_objects()
        before, counts = counts, [sum(isinstance(item, kind) for item in objects) for kind in kinds]
        del objects
        if counts == before:
            return counts
