"""Runs the text of a node program beside a rover."""

from conftest import rovers

from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram


def run_script(folder, text, until=0.5, **changes):
    """Run a node program; return what it has failed with, as text.

    Args:
        folder: Where the program is written.
        text: The program.
        until: The simulation time at which it ends (s).
        changes: Attributes of the twin's builder to set.
    """
    script = folder / "script.py"
    script.write_text(text)
    builder = rovers(1)
    for name, value in changes.items():
        setattr(builder, name, value)
    twin = builder.build()
    nodes = Nodes(twin, [NodeProgram(executable=str(script))])
    try:
        twin.advance_to(until)
    finally:
        nodes.close()
    return " ".join(map(str, twin.more_findings))
