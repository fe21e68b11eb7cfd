"""The wiring tables: every topic, service and action of every cell, once."""
