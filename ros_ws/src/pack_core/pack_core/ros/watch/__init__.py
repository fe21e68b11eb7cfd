"""Watch over the other nodes of a cell: signs of life, and connections to the processes of this machine."""
