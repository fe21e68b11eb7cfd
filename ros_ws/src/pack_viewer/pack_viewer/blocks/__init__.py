"""The blocks cell's page."""
