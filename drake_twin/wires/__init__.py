"""Wires between a twin and the world outside: they see bytes, names of types, hashes and times."""
