"""The blocks cell as a MuJoCo model."""
