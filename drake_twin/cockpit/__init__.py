"""The browser page: Drake's Meshcat with the robots, and the controls in its panel."""
