"""What an evaluated launch file starts, as a Scenario."""
