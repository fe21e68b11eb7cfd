"""The baseline: pIRS over a probabilistic roadmap, as Sotiropoulos and Sandzimier describe it."""
