"""Claims of the paper: statements, evidence and verdicts."""
