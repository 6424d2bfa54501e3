"""Stand-in for ``rosidl_parser``, of which programs use `definition.NamespacedType`."""
