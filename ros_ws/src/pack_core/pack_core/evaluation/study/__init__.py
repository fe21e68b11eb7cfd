"""Many runs together: the paper's tables, its figure of the failure metrics, and a report."""
