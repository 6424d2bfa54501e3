"""Wires to the outside: they see bytes, type names, hashes and times, and nothing of the twin."""
