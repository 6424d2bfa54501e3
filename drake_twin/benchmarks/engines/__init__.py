"""The engines that are timed, one a file; all answer to the same few calls."""
