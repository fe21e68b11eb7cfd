"""What the page hears from a running cell, and what it asks of it."""
