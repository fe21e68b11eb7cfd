"""`pack benchmark CELL`: one module a cell, each with a function `benchmark` that is its command."""
