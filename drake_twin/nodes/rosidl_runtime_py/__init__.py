"""Interfaces by their names: ``rosidl_runtime_py.utilities``."""
