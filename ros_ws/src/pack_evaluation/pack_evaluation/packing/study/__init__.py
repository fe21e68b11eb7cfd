"""Many runs together: the tables of the paper, its figure of the failure metrics, and a report."""
