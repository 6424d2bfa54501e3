"""The speed of the twin beside the bare Drake plant, DART, MuJoCo and PyBullet, with the same robots in the same run.

``python -m drake_twin.benchmarks`` measures it and needs the extra ``benchmarks``.
"""
