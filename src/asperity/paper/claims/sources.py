"""The surfaces of a configuration and the validation datasets from which the claims are judged.

Every job of the workflow imports this module. Therefore it imports nothing that takes time.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from asperity.core.data import packaged_yaml

DATASETS = ("load_area", "slab_load_area", "grid_convergence", "elements", "punch")
"""Datasets of stage validation from which claims are judged."""

OPTIONS = packaged_yaml("asperity.paper.claims", "paper.yaml")["choices"]
"""Choice that the paper leaves open → its options; most of them with words, as `paper.yaml` explains."""

CHOICES: dict[str, tuple[Any, ...]] = {name: tuple(options) for name, options in OPTIONS.items()}
"""Choice that the paper leaves open → its options, the study's own first."""

SKEWED = ("skew_negative", "skew_positive")
"""Roles of the surfaces of the study of skewness that have a δ."""


def roles(studies: Mapping[str, Sequence[str]], surfaces: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Surfaces of the configuration by their role in the claims, found by their parameters.

    Parameters
    ----------
    studies, surfaces : mappings
        Sections of these names of the configuration.

    Returns
    -------
    dict
        Role → name of a surface. Roles that no surface has are left out.
    """

    def ranked(study: str, names: Sequence[str], key: Callable[[Mapping[str, Any]], float]) -> dict[str, str]:
        """The surfaces of a study by rising key, if it has as many as there are roles."""
        found = sorted((n for n in studies.get(study, ()) if n in surfaces), key=lambda n: key(surfaces[n]))
        return dict(zip(names, found, strict=True)) if len(found) == len(names) else {}

    def gamma(surface: Mapping[str, Any]) -> float:
        return surface.get("johnson", {}).get("gamma", 0.0)

    def kurtosis(surface: Mapping[str, Any]) -> float:
        return surface.get("moments", {}).get("kurtosis", 3.0)

    cutoffs: tuple[str, ...] = ("long_cutoff", "middle_cutoff", "short_cutoff")
    if len(studies.get("kurtosis", ())) == 2:
        cutoffs = cutoffs[::2]
    return {
        **ranked("hurst", ("small_hurst", "large_hurst"), lambda s: s["hurst"]),
        **ranked("compressibility", ("compressibility",), lambda s: 0.0),
        **ranked("skewness", ("skew_negative", "gaussian", "skew_positive"), gamma),
        **ranked("kurtosis", cutoffs, lambda s: -s["wavelength_short"]),
        **ranked("moments", ("kurtosis_low", "kurtosis_normal", "kurtosis_high"), kurtosis),
    }


def role_of_delta(role: str, delta: float) -> str:
    """Role of a skewed surface with a given δ."""
    return f"{role}, delta {delta:g}"


def surfaces_by_delta(
    by_role: Mapping[str, str], surfaces: Mapping[str, Mapping[str, Any]]
) -> dict[float, dict[str, str]]:
    """Surfaces of study ``skewness``, and surfaces that differ from them in their δ alone.

    Parameters
    ----------
    by_role : mapping
        Role → name of a surface, as of `roles`.
    surfaces : mapping
        Section of this name of the configuration.

    Returns
    -------
    dict
        δ → role at this δ (`role_of_delta`) → name of a surface. The study's own δ is the first one. Empty
        without such a study; values of δ for which surfaces are missing are left out.
    """
    own = {role: name for role, name in by_role.items() if role in SKEWED}
    if not own or not all("johnson" in surfaces[name] for name in own.values()):
        return {}
    found: dict[float, dict[str, str]] = {}
    for delta in (surfaces[own[SKEWED[0]]]["johnson"]["delta"], *CHOICES["delta"]):
        twins = {
            role_of_delta(role, delta): name
            for role, twin in own.items()
            for name, surface in surfaces.items()
            if surface.get("johnson", {}).get("delta") == delta
            and _but_for_delta(surface) == _but_for_delta(surfaces[twin])
        }
        if len(twins) == len(SKEWED):
            found.setdefault(delta, twins)
    return found


def _but_for_delta(surface: Mapping[str, Any]) -> dict[str, Any]:
    """Entry of a surface without its label and its δ."""
    johnson = {key: value for key, value in surface.get("johnson", {}).items() if key != "delta"}
    return {**surface, "label": "", "johnson": johnson}
