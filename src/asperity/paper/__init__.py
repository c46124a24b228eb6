"""The paper of the study: its figures and its claims."""
