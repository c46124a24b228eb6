"""The instrument as a page in the browser: a form over `asperity.settings`, and a view of answers.

The page computes nothing: processes of their own read maps, press them and compute planes of the stress, by
the functions that ``asperity run`` and ``asperity view`` use. `form` makes the fields from `Case`,
``page.html.j2`` lays them out, and ``updates.html.j2`` the parts that change; `session` takes the texts of
the fields, and `server` serves the page.
"""
