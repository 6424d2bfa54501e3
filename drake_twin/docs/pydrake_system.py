"""Directives for Sphinx, and the line breaks of long names in tables.

``pydrake_system`` draws a LeafSystem's ports, ``names_of`` documents a module under the names that users import, and
``room`` the modules of a package.
"""

import inspect
import re
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


class NamesOf(SphinxDirective):
    """Document the classes and functions of a module, each under the shortest name by which it is imported."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the documentation of the module's text, and of its names in their order."""
        parsed: list[nodes.Node] = self.parse_text_to_nodes(_documented(self.arguments[0]))
        return parsed


class Room(SphinxDirective):
    """Document the modules of a package, each as ``names_of`` does."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the documentation of all modules but the programs."""
        package = self.arguments[0]
        names = [item.name for item in iter_modules(import_module(package).__path__) if item.name != "__main__"]
        titles = {name: f"{package.rpartition('.')[2]}.{name}" for name in names}
        blocks = [
            f"{title}\n{'-' * len(title)}\n\n{_documented(f'{package}.{name}')}" for name, title in titles.items()
        ]
        parsed: list[nodes.Node] = self.parse_text_to_nodes("\n".join(blocks), allow_section_headings=True)
        return parsed


def _documented(module: str) -> str:
    """Return the directives that document a module."""
    blocks = [f".. automodule:: {module}\n"]
    found = import_module(module)
    for name, value in vars(found).items():
        is_own = getattr(value, "__module__", None) == module and not name.startswith("_") and inspect.getdoc(value)
        if is_own and (inspect.isclass(value) or inspect.isroutine(value)):
            kind = "exception" if _is_exception(value) else "class" if inspect.isclass(value) else "function"
            options = "" if kind == "function" else "   :members:\n   :show-inheritance:\n"
            blocks.append(f".. auto{kind}:: {imported_name(module, name, value)}\n{options}")
    return "\n".join(blocks)


def imported_name(module: str, name: str, value: Any) -> str:
    """Return the shortest name by which something of a module is imported from one of the packages around it."""
    parts = module.split(".")
    for count in range(1, len(parts)):
        package = import_module(".".join(parts[:count]))
        if name in getattr(package, "__all__", ()) and getattr(package, name) is value:
            return f"{package.__name__}.{name}"
    return f"{module}.{name}"


def _is_exception(value: Any) -> bool:
    return inspect.isclass(value) and issubclass(value, BaseException)


def _port(name: str) -> str:
    return f"``{name}``" if name else ""


def _shorten(app: Sphinx, what: str, name: str, item: Any, *_: Any) -> tuple[str, None] | None:
    """Leave out the signature of a dataclass: its fields are listed below it."""
    return ("", None) if what == "class" and is_dataclass(item) else None


def _resolve(
    app: Sphinx, environment: BuildEnvironment, node: addnodes.pending_xref, text: nodes.TextElement
) -> nodes.reference | None:
    """Link a name that is documented once, in any module: ``Twin`` in a docstring, the place of a class in a type."""
    domain, name = environment.domains.python_domain, node["reftarget"]
    if node.get("reftype") != "obj" and not name.startswith("drake_twin."):
        return None
    last = name.rpartition(".")[2] if name.startswith("drake_twin.") else name
    names = [item for item in domain.objects if item.endswith(f".{last}")]
    if len(names) != 1:
        return None
    found = domain.objects[names[0]]
    return make_refnode(app.builder, node["refdoc"], found.docname, found.node_id, text, names[0])


def _break_names(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Let the browser break long names in tables after their parts, so that no table is wider than its page."""
    if "body" in context:
        context["body"] = _TABLE.sub(lambda table: _TEXT.sub(_broken, table[0]), context["body"])


_TABLE = re.compile(r"(?<=<table).*?(?=</table>)", re.DOTALL)
_TEXT = re.compile(r">[^<]+")  # between two tags
_LONG_NAME = re.compile(r"[^\s>]{16,}")
_PARTS = re.compile(r"(?<=[_/.:,=\[(|])(?=\w)|(?<=[a-z])(?=[A-Z])")


def _broken(text: re.Match[str]) -> str:
    return _LONG_NAME.sub(lambda name: _PARTS.sub("<wbr>", name[0]), text[0])


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directives, the rule for dataclasses, and the line breaks."""
    app.connect("html-page-context", _break_names)
    app.connect("autodoc-process-signature", _shorten)
    app.connect("missing-reference", _resolve)
    app.add_directive("pydrake_system", PydrakeSystem)
    app.add_directive("names_of", NamesOf)
    app.add_directive("room", Room)
    return {"parallel_read_safe": True}
