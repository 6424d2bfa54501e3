"""Stand-ins for ROS's ``launch``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "action": "Action",
        "condition": "Condition",
        "event": "Event",
        "event_handler": "EventHandler",
        "launch_context": "LaunchContext",
        "launch_description": "LaunchDescription",
        "launch_description_entity": "LaunchDescriptionEntity",
        "launch_description_source": "LaunchDescriptionSource",
        "launch_introspector": "LaunchIntrospector",
        "launch_service": "LaunchService",
        "some_entities_type": "SomeActionsType SomeEntitiesType",
        "some_substitutions_type": "SomeSubstitutionsType SomeSubstitutionsType_types_tuple",
        "substitution": "Substitution",
    },
)
