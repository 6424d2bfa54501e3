"""A wire of somebody else's, in one file: a line for each message, with its time, topic and size."""

from pathlib import Path

from drake_twin.wires.registry import WireKind, wire_kind


@wire_kind
class LinesKind(WireKind):
    """``--lines FILE``."""

    name = "lines"
    has_peers = False

    def add_options(self, group):
        group.add_argument("--lines", type=Path, metavar="FILE", help="write a line for each message")

    def is_wanted(self, options):
        return options.lines is not None

    def open(self, options, asset, *, is_first):
        return LinesWire(options.lines)


class LinesWire:
    """Writes lines; nothing comes in."""

    def __init__(self, file):
        self._file = file.open("w")

    def advertise(self, topic, listened):
        listened(True)
        return LinesSender(self._file, topic.name)

    def listen(self, topic, heard):
        return Nothing()

    def serve(self, service, answer):
        return Nothing()

    def close(self):
        self._file.close()


class Nothing:
    def close(self):
        pass


class LinesSender:
    is_heard = True

    def __init__(self, file, topic):
        self._file, self._topic = file, topic

    def send(self, data, time):
        self._file.write(f"{time / 1e9:.3f} {self._topic} {len(data)}\n")

    def close(self):
        pass
