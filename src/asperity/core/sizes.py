"""Sizes of grids, without numpy: a workflow is planned where only Snakemake is installed."""


def good_size(minimum: int) -> int:
    """Smallest even number of nodes ≥ `minimum` whose only prime factors are 2, 3 and 5."""
    half = max(-(-int(minimum) // 2), 1)
    while pow(30, 64, half):  # zero if all its prime factors divide 30
        half += 1
    return 2 * half
