"""Readers of answers: pictures, report, text, tables, samples and comparisons, which compute nothing."""
