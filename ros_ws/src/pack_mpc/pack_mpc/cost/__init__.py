"""The cost that every optimizer lowers: residuals, their norms and their weights (Eq. 2, Table I)."""
