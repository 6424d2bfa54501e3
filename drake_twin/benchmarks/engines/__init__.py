"""The engines that are timed, one a file, each an `drake_twin.benchmarks.engine.Engine`."""
