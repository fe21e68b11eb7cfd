"""The packing cell in lockstep, its benchmark, and the replay of recordings through its cores."""
