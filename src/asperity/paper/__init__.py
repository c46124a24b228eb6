"""The study of one paper: its figures and its claims."""

PAPER = (
    "Y. Murugesan, S. P. Venugopalan, L. Nicola: "
    "On sub-surface stress caused by contact roughness in compressible elastic solids"
)
