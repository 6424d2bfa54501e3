"""An evaluated launch file → Scenario."""
