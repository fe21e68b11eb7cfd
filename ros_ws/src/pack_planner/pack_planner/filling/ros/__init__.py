"""Messages of the filling service."""
