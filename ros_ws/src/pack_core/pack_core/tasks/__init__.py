"""How a task of a cell is written down: what it waits for, asks, and has the arm do, one after the other."""
