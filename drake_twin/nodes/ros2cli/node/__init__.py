"""Nodes with which a program looks at the graph."""
