"""How fast the twin is, beside the bare Drake plant, MuJoCo and PyBullet: the same robots in the same run.

``python -m drake_twin.benchmarks`` measures; this needs the extra ``benchmarks``.
"""
