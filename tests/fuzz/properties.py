"""Table of everything that a user calls: how an input is drawn, and what must hold whatever the input is.

A property is a strategy that draws an input, and a function that tries it and returns the outcome in a few
words. It raises `PromiseError` if a promise is not kept. Every other exception than the package's own is a
defect as well, which the search notices itself.
"""

from command_properties import commands, configs, map_files, try_command, try_config, try_map
from contact_properties import certificates, contacts, paths, try_certificate, try_contact, try_path
from stress_properties import (
    analyses,
    sections,
    statistics,
    stresses,
    try_analysis,
    try_section,
    try_statistics,
    try_stress,
)
from surface_properties import (
    forms,
    grids,
    prepared,
    questions,
    solids,
    surfaces,
    try_form,
    try_grid,
    try_layer,
    try_run,
    try_surface,
    try_treatment,
)

PROPERTIES = {
    "contact": (contacts, try_contact),
    "path": (paths, try_path),
    "certificate": (certificates, try_certificate),
    "stress": (stresses, try_stress),
    "analysis": (analyses, try_analysis),
    "section": (sections, try_section),
    "statistics": (statistics, try_statistics),
    "layer": (solids, try_layer),
    "grid": (grids, try_grid),
    "surface": (surfaces, try_surface),
    "form": (forms, try_form),
    "treatment": (prepared, try_treatment),
    "run": (questions, try_run),
    "command": (commands, try_command),
    "config": (configs, try_config),
    "map": (map_files(), try_map),
}
