"""The figures, one module each: from datasets to a picture, and nothing else.

Every module has one function ``draw`` that takes the datasets it needs, keyed by surface name where
there are several, and returns a `matplotlib.figure.Figure`. Looks live in ``style.mplstyle`` and
`asperity.paper.figures.style`.
"""
