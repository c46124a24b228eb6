"""The questions that a case may ask, each in a file of its own.

A file holds the settings of its question, what it computes in each stage of an answer, and how its part of
the answer is shown. See `asperity.engineering.question`. What a question computes with is imported where it
computes: the command line reads the settings of all questions, and an answer imports what it asks.
"""
