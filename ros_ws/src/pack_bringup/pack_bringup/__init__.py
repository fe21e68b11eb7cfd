"""Brings cells up: graphs, processes, the recorder and the `pack` command."""
