"""The blocks cell as a whole."""
