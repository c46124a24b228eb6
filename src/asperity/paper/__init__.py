"""The study of one paper: its figures and its claims."""
