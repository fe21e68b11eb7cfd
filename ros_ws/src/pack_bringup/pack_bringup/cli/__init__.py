"""The `pack` command: one file a command group."""
