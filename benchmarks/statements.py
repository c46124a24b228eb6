"""Corrected numbers of the paper's statements about H and ν on 8 nodes, against those on 32.

    python benchmarks/statements.py    # writes paper/supplement/statements.csv, in five minutes

The surfaces of both Hurst exponents lie in a cell a quarter as wide as the study's, and are pressed under the
same load on both grids.
"""

import pandas as pd
import xarray as xr

from asperity.paper.claims.numbers import Evidence
from asperity.paper.claims.report import WORDS
from asperity.paper.claims.verdicts import CLAIMS, decide
from asperity.settings.study import read_study
from asperity.stress.analysis import SOUGHT
from asperity.study.stages.contact import press_surface
from asperity.study.stages.statistics import seed_statistics
from asperity.study.stages.stress import stress_of_seed
from asperity.study.stages.surface import make_surface

HURST = {"small_hurst": 0.2, "large_hurst": 0.8, "compressibility": 0.8}
SEEDS = [1, 2]
COLUMNS = ["statement", "on_8_nodes", "corrected", "error", "corrected_on_32_nodes"]
BAND = {"wavelength_long": 0.5, "wavelength_short": 1 / 64, "rms_height": 0.004}


def statistics(hurst: float, nodes: int, loads: dict[tuple[float, int], float]) -> xr.Dataset:
    """Numbers of all seeds of a surface; `loads` keeps the loads of the first grid for the others."""
    config, each = read_study(["config/config.yaml"]), []
    for seed in SEEDS:
        surface = make_surface({"hurst": hurst, **BAND, "points": 64 * nodes}, seed)
        load = (
            {"mean_pressure": loads[hurst, seed]}
            if (hurst, seed) in loads
            else {"contact_area_fraction": 0.1}
        )
        chosen = {name: config["contact"][name] for name in ("method", "tolerance", "precision")}
        contact = press_surface(surface, config["layer"], chosen | load)
        loads.setdefault((hurst, seed), float(contact["mean_pressure"]))
        quantities = [*SOUGHT, "xy"]
        stress = stress_of_seed(contact, config["layer"], config["stress"], ["free"], quantities)
        each.append(seed_statistics(surface, contact, stress))
    return xr.concat(each, "seed").assign_coords(seed=SEEDS).assign_attrs(stress.attrs)


def table() -> pd.DataFrame:
    """Each statement: on 8 nodes, corrected with its stated error, and corrected on 32 nodes."""
    loads: dict[tuple[float, int], float] = {}
    decided = []
    for nodes in (8, 32):
        found = {hurst: statistics(hurst, nodes, loads) for hurst in sorted({*HURST.values()})}
        evidence = Evidence({role: found[hurst] for role, hurst in HURST.items()})
        decided.append(decide(CLAIMS, evidence, {"lateral": ["confined", "free"], "shear": ["xz", "xy"]}))
    rows = []
    for one, other in zip(*decided, strict=True):
        for found, truth in zip(one.judgements, other.judgements, strict=True):
            if found.grid_error > 0:
                options = [WORDS[option] for option in found.interpretation.values() if option in WORDS]
                statement = one.claim.sentence + (f" ({', '.join(options)})" if options else "")
                numbers = found.value_on_grid, found.value, found.grid_error, truth.value
                rows.append((statement, *numbers))
    return pd.DataFrame(rows, columns=COLUMNS)


if __name__ == "__main__":
    table().to_csv("paper/supplement/statements.csv", index=False, float_format="%.4g")
