"""Services for running jobs: progress, logs, checks before a run, compilation, the operating system."""
