"""Pictures of results, of one surface or of several beside each other, and the style of all figures.

`maps` draws height, pressure and gap over the cell, `inside` the stress in a vertical section or in a plane
at a depth, `peaks` the stress peaks over depth. `source` reads results for them, `measures` chooses units,
`colours` the range of the colours.
"""
