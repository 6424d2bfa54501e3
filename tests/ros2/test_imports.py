"""The files of the room import each other in one direction, also inside functions and for type checkers."""

import ast
from pathlib import Path

import drake_twin.ros2

ROOM = Path(drake_twin.ros2.__file__).parent
MOST_LINES = 400


def module_of(file):
    parts = ("drake_twin", "ros2", *file.relative_to(ROOM).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_of(file): file for file in sorted(ROOM.rglob("*.py"))}


def imported(module):
    """The files of the room that a file imports, anywhere in it; a package imports what it exports lazily."""
    found = set()
    if "classes_in(" in FILES[module].read_text() and FILES[module].name == "__init__.py":
        found |= {f"{module}.{file.stem}" for file in FILES[module].parent.glob("*.py")}
    for node in ast.walk(ast.parse(FILES[module].read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module} imports relatively"
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
        elif isinstance(node, ast.Dict) and "lazy_exports(" in FILES[module].read_text():
            keys = [key.value for key in node.keys if isinstance(key, ast.Constant)]
            found |= {f"drake_twin.ros2.{key}" if "." in key else f"{module}.{key}" for key in keys}
    return sorted((found & set(FILES)) - {module, "drake_twin.ros2"})


def circles(graph):
    """The strongly connected components of more than one node (Tarjan)."""
    found, stack, numbers, lowest = [], [], {}, {}

    def visit(node):
        numbers[node] = lowest[node] = len(numbers)
        stack.append(node)
        for following in graph[node]:
            if following not in numbers:
                visit(following)
                lowest[node] = min(lowest[node], lowest[following])
            elif following in stack:
                lowest[node] = min(lowest[node], numbers[following])
        if lowest[node] == numbers[node]:
            position = stack.index(node)
            if len(stack) - position > 1:
                found.append(sorted(stack[position:]))
            del stack[position:]

    for node in graph:
        if node not in numbers:
            visit(node)
    return found


def test_circles_are_found():
    graph = {"a": ["b"], "b": ["c", "d"], "c": ["a"], "d": ["e"], "e": ["d", "f"], "f": []}
    assert circles(graph) == [["d", "e"], ["a", "b", "c"]]


def test_imports_inside_functions_for_type_checkers_and_of_exports_count():
    assert "drake_twin.ros2.python_file" in imported("drake_twin.ros2.launch_files")
    assert "drake_twin.ros2.launch.launch_context" in imported("drake_twin.ros2.visiting")
    assert "drake_twin.ros2.launch.actions.timer_action" in imported("drake_twin.ros2.launch.actions")


def test_no_files_import_each_other_in_a_circle():
    assert circles({module: imported(module) for module in FILES}) == []


def test_no_file_is_too_long():
    lines = {module: len(file.read_text().splitlines()) for module, file in FILES.items()}
    assert {module: count for module, count in lines.items() if count > MOST_LINES} == {}
