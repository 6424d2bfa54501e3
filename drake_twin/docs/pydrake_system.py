"""Directives for Sphinx: ``pydrake_system`` draws a LeafSystem's ports, ``room`` documents a package's modules."""

from dataclasses import is_dataclass
from importlib import import_module
from itertools import zip_longest
from pkgutil import iter_modules
from typing import Any

import yaml
from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import make_refnode


class PydrakeSystem(SphinxDirective):
    """Draw the block that Drake's documentation has: input ports, the system's name, output ports."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the block as a table.

        Raises:
            DirectiveError: If the content is not the YAML of a system with a name.
        """
        try:
            system = yaml.safe_load("\n".join(self.content))
            name, inputs, outputs = system["name"], system.get("input_ports") or [], system.get("output_ports") or []
        except (yaml.YAMLError, TypeError, KeyError, AttributeError) as error:
            raise self.error(f"pydrake_system: {error!r} in {list(self.content)}") from error
        rows = "\n".join(
            f"   * - {_port(own)}\n     - {f'**{name}**' if row == 0 else ''}\n     - {_port(out)}"
            for row, (own, out) in enumerate(zip_longest(inputs, outputs, fillvalue="") or [("", "")])
        )
        table = f".. list-table::\n   :header-rows: 1\n\n   * - input ports\n     -\n     - output ports\n{rows}"
        parsed: list[nodes.Node] = self.parse_text_to_nodes(table)
        return parsed


class Room(SphinxDirective):
    """Document the modules of a package, each as ``automodule`` does."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the documentation of all modules but the programs."""
        package = self.arguments[0]
        names = [item.name for item in iter_modules(import_module(package).__path__) if item.name != "__main__"]
        titles = {name: f"{package.rpartition('.')[2]}.{name}" for name in names}
        blocks = [
            f"{title}\n{'-' * len(title)}\n\n.. automodule:: {package}.{name}\n   :members:\n   :show-inheritance:\n"
            for name, title in titles.items()
        ]
        parsed: list[nodes.Node] = self.parse_text_to_nodes("\n".join(blocks), allow_section_headings=True)
        return parsed


def _port(name: str) -> str:
    return f"``{name}``" if name else ""


def _shorten(app: Sphinx, what: str, name: str, item: Any, *_: Any) -> tuple[str, None] | None:
    """Leave out the signature of a dataclass: its fields are listed below it."""
    return ("", None) if what == "class" and is_dataclass(item) else None


def _resolve(
    app: Sphinx, environment: BuildEnvironment, node: addnodes.pending_xref, text: nodes.TextElement
) -> nodes.reference | None:
    """Link a name in a docstring that is documented once, in any module: ``Twin``, ``drake_twin.Twin``."""
    if node.get("reftype") != "obj":
        return None
    domain, name = environment.domains.python_domain, node["reftarget"]
    last = name.rpartition(".")[2] if name.startswith("drake_twin.") else name
    names = [item for item in domain.objects if item.endswith(f".{last}")]
    if len(names) != 1:
        return None
    found = domain.objects[names[0]]
    return make_refnode(app.builder, node["refdoc"], found.docname, found.node_id, text, names[0])


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directives, and the rule for dataclasses."""
    app.connect("autodoc-process-signature", _shorten)
    app.connect("missing-reference", _resolve)
    app.add_directive("pydrake_system", PydrakeSystem)
    app.add_directive("room", Room)
    return {"parallel_read_safe": True}
