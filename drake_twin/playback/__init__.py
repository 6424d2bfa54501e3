"""Bags as the page shows them: robots from their descriptions, posed by the recorded transforms and joint states."""
