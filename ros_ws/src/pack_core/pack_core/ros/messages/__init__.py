"""Messages to values of the cores and back."""
