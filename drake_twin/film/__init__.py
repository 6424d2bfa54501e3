"""Films and pictures of a run, without a browser: each picture shows a simulation time, however fast the machine is."""
