"""From a reference to commanded joints: policies, joint limits, and a reference that waits."""
