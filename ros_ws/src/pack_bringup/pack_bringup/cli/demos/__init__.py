"""`pack demo CELL`: one module a cell, each with a function `demo` that is its command."""
