import gc
import weakref

from drake_twin.systems.weak_callback import weakly


class Thing:
    def __init__(self):
        self.seen = []
        self.callback = weakly(self.see)

    def see(self, value):
        self.seen.append(value)


def test_the_callback_calls_the_method():
    thing = Thing()
    thing.callback(3)
    assert thing.seen == [3]


def test_the_callback_does_not_keep_its_object_alive():
    thing = Thing()
    callback, reference = thing.callback, weakref.ref(thing)
    gc.disable()
    try:
        del thing
        assert reference() is None
    finally:
        gc.enable()
    assert callback is not None
