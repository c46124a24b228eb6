"""The list of figures and the results that each is drawn from."""

from asperity.paper.figures import figures_of


def test_results_are_a_tree_of_stages_studies_surfaces():
    studies = {"hurst": ["a"], "moments": ["b", "c"], "measured": [], "skewness": ["a"], "kurtosis": ["c"]}
    config = {"studies": {**studies, "mine": ["d"]}, "figures": "paper", "validation": ["punch"]}
    figures = figures_of({**config, "stress": {"poisson": [0.3]}})

    def tree(name):
        return figures[name].results(config["studies"], lambda stage, surface: f"{stage}/{surface}")

    assert tree("fig07") == {"contact": {"a": "contact/a"}}
    assert tree("fig10_moments") == {"statistics": {"b": "statistics/b", "c": "statistics/c"}}
    both = {"skewness": {"a": "statistics/a"}, "kurtosis": {"c": "statistics/c"}}
    assert tree("fig17") == {"statistics": both}
    assert tree("fig12") == {"validation": {"punch": "validation/punch"}}
    assert tree("peaks_mine") == {"statistics": {"d": "statistics/d"}}
    assert not {"fig10_measured", "fig01", "poisson_decay_mine"} & figures.keys()
