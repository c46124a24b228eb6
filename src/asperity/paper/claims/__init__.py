"""Claims of the paper: their sources and evidence, the statements, the verdicts, and the report."""
