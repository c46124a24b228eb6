"""The questions that a case may ask, each in a file of its own.

A file holds the settings of its question, its computation in each stage of an answer, and the display of its
part of the answer. See `asperity.engineering.question`. A question imports a module where it computes with
it: the command line reads the settings of all questions, and an answer imports what it asks.
"""
