"""The instrument as a page in the browser: a form over `asperity.settings`, and a view of answers.

The page computes nothing: processes of their own read maps, press them and compute planes of the stress, by
the functions that ``asperity run`` and ``asperity view`` use.
"""
