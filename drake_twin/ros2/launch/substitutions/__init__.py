"""Stand-ins for ``launch.substitutions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "anon_name": "AnonName",
        "boolean_substitution": "AllSubstitution AndSubstitution AnySubstitution NotSubstitution OrSubstitution",
        "command": "Command",
        "environment_variable": "EnvironmentVariable",
        "equals_substitution": "EqualsSubstitution",
        "file_content": "FileContent",
        "find_executable": "FindExecutable",
        "for_loop_var": "ForEachVar ForLoopIndex",
        "if_else_substitution": "IfElseSubstitution",
        "launch_configuration": "LaunchConfiguration",
        "launch_log_dir": "LaunchLogDir",
        "local_substitution": "LocalSubstitution",
        "not_equals_substitution": "NotEqualsSubstitution",
        "path_join_substitution": "PathJoinSubstitution PathSubstitution",
        "python_expression": "PythonExpression",
        "string_join_substitution": "StringJoinSubstitution",
        "launch.substitution": "Substitution",
        "substitution_failure": "SubstitutionFailure",
        "text_substitution": "TextSubstitution",
        "this_launch_file": "ThisLaunchFile",
        "this_launch_file_dir": "ThisLaunchFileDir",
    },
)
