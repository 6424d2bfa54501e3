"""From the elements of XML and YAML launch files to actions (``launch.frontend.parser``)."""

from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.frontend.entity import Entity, MissingAttributeError
from drake_twin.ros2.launch.frontend.expose import ACTIONS
from drake_twin.ros2.launch.frontend.parse_substitution import parse_substitution
from drake_twin.ros2.launch.launch_description_entity import LaunchDescriptionEntity
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution
from drake_twin.ros2.launch_errors import launch_error
from drake_twin.ros2.launch_extensions import extension_problems

_OF_ROS_1 = ("env", "machine", "param", "remap", "rosparam", "test")


class Parser:
    """Makes actions of elements; the ``parse`` methods of actions are given one."""

    def parse_action(self, entity: Entity) -> LaunchDescriptionEntity:
        """Return the action of an element.

        Raises:
            InputError: If the element or one of its attributes is unknown, or an attribute is missing or wrong.
        """
        with current_context().at(entity.place):
            return self._action(entity)

    def _action(self, entity: Entity) -> LaunchDescriptionEntity:
        tag = entity.type_name.replace("-", "_")
        method = ACTIONS.get(tag)
        of_ros_1 = tag in _OF_ROS_1 or "ns" in entity or (tag == "node" and "type" in entity)
        if of_ros_1 and not ACTIONS.is_of_others(tag):
            raise entity.error("this is a ROS 1 launch file, and the twin reads those of ROS 2")
        if method is None:
            message = f"unknown element{extension_problems()}"
            raise entity.error(message, value=entity.type_name, valid=sorted(ACTIONS))
        if not ACTIONS.is_in_jazzy(tag):
            entity.refused_by_ros("ROS 2 Jazzy has no such element")
        try:
            kind, arguments = method(entity, self)
            entity.assert_entity_completely_parsed()
            action: LaunchDescriptionEntity = kind(**arguments)
        except MissingAttributeError as error:
            if error.entity is entity:
                entity.refuse_unknown(lambda entity: method(entity, self))
            raise
        except InputError as error:
            if error.file is not None:
                raise
            raise entity.error(error.message, valid=error.valid, value=error.value) from None
        except Exception as error:  # a package's own parse method raises whatever it likes
            raise launch_error(error, current_context(), entity.place.file) from None
        action.place = entity.place
        return action

    @staticmethod
    def parse_substitution(value: str) -> list[Substitution]:
        """Return text with ``$(…)`` in it as substitutions.

        Raises:
            InputError: If a parenthesis is missing, or a substitution is unknown or has wrong arguments.
        """
        return parse_substitution(value)

    @staticmethod
    def parse_if_substitutions(value: Any) -> Any:
        """Return text that holds substitutions, alone or in a list, as substitutions; other values as they are."""
        if isinstance(value, list):
            return [Parser.parse_if_substitutions(item) for item in value]
        parts = parse_substitution(value) if isinstance(value, str) else []
        if len(parts) == 1 and isinstance(parts[0], TextSubstitution):
            return parts[0].text
        return parts or value

    def parse_optional(self, entity: Entity, *names: str) -> dict[str, list[Substitution]]:
        """Return those attributes that an element has, as substitutions; the keys are the names with ``_``."""
        given = {name.replace("-", "_"): entity.get_attr(name, optional=True) for name in names}
        return {name: parse_substitution(value) for name, value in given.items() if value is not None}

    def parse_required(self, entity: Entity, *names: str) -> dict[str, list[Substitution]]:
        """Return attributes of an element as substitutions.

        Raises:
            InputError: If one is missing.
        """
        return {name: parse_substitution(entity.get_attr(name)) for name in names}

    def parse_children(self, entity: Entity, tag: str, *names: str) -> list[dict[str, list[Substitution]]]:
        """Return attributes of each child with a tag, which has them and no others, as substitutions.

        Raises:
            InputError: If one is missing or unknown.
        """
        found = []
        for child in entity.children_named(tag):
            found.append(self.parse_required(child, *names))
            child.assert_entity_completely_parsed()
        return found
