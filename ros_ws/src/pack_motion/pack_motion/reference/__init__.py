"""References the arm can follow: within all joint limits, jerk-limited, without needless stops."""
