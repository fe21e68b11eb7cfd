"""A running cell as an OPC UA server: what a PLC reads of it, and asks of it."""
