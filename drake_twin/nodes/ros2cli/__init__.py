"""Stand-in for ``ros2cli``: the node with which a program looks at the graph, in ``ros2cli.node.strategy``."""
