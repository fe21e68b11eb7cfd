"""Where the frames that perception uses come from."""
