"""Stand-ins for ``launch.frontend``: how XML and YAML launch files become actions."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "entity": "Entity",
        "expose": "expose_action expose_substitution",
        "parser": "Parser",
    },
)
