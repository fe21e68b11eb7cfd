"""The blocks cell: physical facts, problems and plans, and its MuJoCo model."""
