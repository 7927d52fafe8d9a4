"""What every run of a solver shares: its checks, its deadline, its progress, its result."""
