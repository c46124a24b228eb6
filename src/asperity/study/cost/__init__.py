"""Accuracy and cost: measured errors, plans, and the resources of every job."""
