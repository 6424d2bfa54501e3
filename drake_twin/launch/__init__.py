"""Front ends that end in a `drake_twin.scenario.Scenario`."""
