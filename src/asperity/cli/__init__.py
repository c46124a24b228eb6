"""The command line of asperity."""
