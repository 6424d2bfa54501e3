"""Many twins of one scenario: varied values, episodes, the processes that run them, and the table of their results."""
