"""The plots of docs/performance.md, from the tables in docs/performance."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

mpl.use("Agg")

TARGET = 1e-6
"""True error at which solvers are compared."""

FAST = "active_set float64"

# Colours that people with any colour vision tell apart (Okabe & Ito), with markers of their own.
STYLES = {
    FAST: ("#0072B2", "o", "asperity"),
    "active_set float32": ("#56B4E9", "^", "asperity, single precision"),
    "gfmd float64": ("#009E73", "s", "GFMD (asperity)"),
    "tamaas": ("#D55E00", "D", "tamaas"),
    "ContactMechanics": ("#CC79A7", "v", "ContactMechanics"),
}

PRECISION = {"float64": "double", "float32": "single"}

STEEPEST = 1.05
"""Exponent of the number of nodes in the time that is aimed at."""


def periodic(table: pd.DataFrame) -> pd.DataFrame:
    """Runs on one thread over a periodic boundary at the load that is shown."""
    chosen = (table["boundary"] == "periodic") & (table["threads"] == 1) & (table["load"] == 0.05)
    return table[chosen]


def at_error(runs: pd.DataFrame, target: float = TARGET, column: str = "seconds") -> tuple[float, bool]:
    """Cost of a solver at a true error, and True if it is a bound.

    Between two runs the logarithms are interpolated. If every run is more accurate, the least accurate one
    is a bound from above; if none is accurate enough, the cost is NaN.
    """
    runs = runs.dropna(subset=["error"]).sort_values("error", ascending=False)
    error, cost = runs["error"].to_numpy(), runs[column].to_numpy()
    below = np.flatnonzero(error <= target)
    if not below.size:
        return np.nan, False
    k = below[0]
    if k == 0:
        return float(cost[0]), True
    share = np.log(error[k - 1] / target) / np.log(error[k - 1] / error[k])
    return float(np.exp((1 - share) * np.log(cost[k - 1]) + share * np.log(cost[k]))), False


def by_grid(runs: pd.DataFrame, column: str = "seconds") -> tuple[np.ndarray, np.ndarray]:
    """Grids, and the cost of a solver on each at the true error that is compared."""
    found = [(points, at_error(some, TARGET, column)[0]) for points, some in runs.groupby("points")]
    values = np.array(found).reshape(-1, 2)
    values = values[np.isfinite(values[:, 1])]
    return values[:, 0], values[:, 1]


def fast_runs(table: pd.DataFrame, hurst: float) -> pd.DataFrame:
    """Runs of the fast solver at its default tolerance, by grid."""
    chosen = (table["solver"] == FAST) & (table["tolerance"] == TARGET) & (table["hurst"] == hurst)
    return table[chosen].sort_values("points")


def draw(folder: Path) -> None:
    """Draw every plot whose numbers there are."""
    contact, roofline = folder / "contact.csv", folder / "roofline.csv"
    if contact.exists():
        table = periodic(pd.read_csv(contact))
        draw_grids(table, "seconds", "processor time, s", folder / "time.png")
        draw_grids(table, "memory_GB", "peak memory of the process, GB", folder / "memory.png")
        draw_errors(table, folder / "errors.png")
        draw_growth(table, folder / "growth.png")
    if roofline.exists():
        draw_roofline(pd.read_csv(roofline), folder / "roofline.png")


def panels(hursts: list[float], height: float = 3.4, **settings: object) -> tuple[Figure, np.ndarray]:
    """A figure with a panel for each Hurst exponent."""
    figure = Figure(figsize=(8.6, height), layout="constrained")
    axes = figure.subplots(1, len(hursts), squeeze=False, **settings)[0]
    for axis, hurst in zip(axes, hursts, strict=True):
        axis.set_title(f"$H$ = {hurst}", loc="left", fontsize="medium")
        axis.grid(color="0.9", linewidth=0.6)
    return figure, axes


def label_grids(axis: mpl.axes.Axes, points: np.ndarray) -> None:
    axis.set_xscale("log", base=2)
    axis.set_xticks(points, [f"{value:.0f}²" for value in points])
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set(xlabel="nodes")


def save(figure: Figure, path: Path) -> None:
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", fontsize=8, frameon=False)
    figure.savefig(path, dpi=150, metadata={"Software": None})


def draw_grids(table: pd.DataFrame, column: str, name: str, path: Path) -> None:
    """Cost of every solver against the grid, and the transforms of the fast one."""
    hursts = sorted(table["hurst"].unique())
    figure, axes = panels(hursts, sharey=True)
    for axis, hurst in zip(axes, hursts, strict=True):
        fast = fast_runs(table, hurst)
        for solver, (colour, marker, label) in STYLES.items():
            if solver == "active_set float32":
                continue
            some = table[(table["solver"] == solver) & (table["hurst"] == hurst)]
            points, cost = (fast["points"], fast[column]) if solver == FAST else by_grid(some, column)
            if len(points):
                axis.plot(points, cost, color=colour, marker=marker, markersize=4, label=label)
        if column == "seconds":
            axis.plot(fast["points"], fast["transform_seconds"], "k--", label="transforms of asperity", lw=1)
            axis.plot(fast["points"], fast["pair_seconds"], "k:", label="one pair, double precision", lw=1)
        else:
            axis.plot(
                fast["points"], 8e-9 * fast["points"] ** 2, "k:", label="one array, double precision", lw=1
            )
        axis.set_yscale("log")
        label_grids(axis, np.sort(table.loc[table["hurst"] == hurst, "points"].unique()))
    axes[0].set(ylabel=name)
    save(figure, path)


def draw_errors(table: pd.DataFrame, path: Path) -> None:
    """True error against processor time, on the largest grid that another program has solved."""
    known = table.dropna(subset=["error"])
    runs = known[known["solver"] == FAST].groupby(["points", "hurst"]).size()
    compared = known.loc[known["solver"].isin(["tamaas", "ContactMechanics"]), "points"]
    largest = compared.max() if len(compared) else runs[runs == runs.max()].index[-1][0]
    known = known[known["points"] == largest]
    hursts = sorted(known["hurst"].unique())
    figure, axes = panels(hursts, sharex=True, sharey=True)
    for axis, hurst in zip(axes, hursts, strict=True):
        for solver, (colour, marker, label) in STYLES.items():
            some = known[(known["solver"] == solver) & (known["hurst"] == hurst)].sort_values("seconds")
            if some.empty:
                continue
            axis.loglog(
                some["seconds"], some["error"], color=colour, marker=marker, markersize=4, label=label
            )
        axis.axhline(TARGET, color="0.5", linewidth=0.8, linestyle="--")
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.set(xlabel=f"processor time, s, {known['points'].iloc[0]}² nodes")
    axes[0].set(ylabel="relative error of the pressure")
    save(figure, path)


def draw_growth(table: pd.DataFrame, path: Path) -> None:
    """Time for each node against the grid, over that on the smallest grid."""
    hursts = sorted(table["hurst"].unique())
    figure, axes = panels(hursts, 3.0, sharey=True)
    for axis, hurst in zip(axes, hursts, strict=True):
        fast = fast_runs(table, hurst)
        nodes = fast["points"].to_numpy(float) ** 2
        curves = {
            "seconds": ("#0072B2", "o-", "contact"),
            "transform_seconds": ("#D55E00", "s--", "its transforms"),
            "pair_seconds": ("#009E73", "^:", "one pair, double precision"),
        }
        for column, (colour, style, label) in curves.items():
            each = fast[column].to_numpy() / nodes
            axis.plot(fast["points"], each / each[0], style, color=colour, markersize=4, label=label)
        limit = (nodes / nodes[0]) ** (STEEPEST - 1)
        axis.plot(fast["points"], limit, color="k", linewidth=0.8, label=f"nodes$^{{{STEEPEST}}}$")
        label_grids(axis, fast["points"].to_numpy())
    axes[0].set(ylabel="time for each node, relative", ylim=(0, None))
    save(figure, path)


def draw_roofline(table: pd.DataFrame, path: Path) -> None:
    """Rate of each kernel against its operations for each byte, below the ceilings of the machine."""
    ceilings = table[table["kernel"].isin(["memory", "matrix product"])]
    bandwidth = ceilings.loc[ceilings["kernel"] == "memory", "GB/s"].iloc[0]
    peaks = ceilings[ceilings["kernel"] == "matrix product"].set_index("precision")["GFlop/s"]
    figure = Figure(figsize=(8.6, 3.8), layout="constrained")
    axis = figure.subplots()
    intensity = np.geomspace(0.05, 50, 200)
    for (precision, peak), style in zip(peaks.items(), ("-", "--"), strict=True):
        roof = np.minimum(bandwidth * intensity, peak)
        axis.loglog(intensity, roof, f"k{style}", lw=1.2, label=f"{peak:.0f} GFlop/s, {PRECISION[precision]}")
    axis.text(0.055, 0.075 * bandwidth, f"{bandwidth:.0f} GB/s", rotation=33, fontsize=8, va="bottom")
    colours = [colour for colour, *_ in STYLES.values()] + ["#E69F00"]
    kernels = table[~table["kernel"].isin(["memory", "matrix product"])]
    for number, (kernel, some) in enumerate(kernels.groupby("kernel", sort=False)):
        colour, marker = colours[number % len(colours)], "osD^v<>"[number % 7]
        for _, row in some.iterrows():
            double = row["precision"] == "float64"
            axis.plot(
                row["intensity"],
                row["GFlop/s"],
                marker,
                color=colour,
                markerfacecolor=colour if double else "white",
                markersize=7,
                linestyle="none",
                label=f"{kernel}, {PRECISION[row['precision']]}",
            )
    axis.grid(color="0.9", linewidth=0.6)
    axis.set(xlabel="operations for each byte of memory", ylabel="GFlop/s, one thread", ylim=(0.3, None))
    save(figure, path)
