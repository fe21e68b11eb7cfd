"""How full containers were filled: measures of fill jobs, side by side."""
