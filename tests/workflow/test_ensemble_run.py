"""The rules of ensembles: pilot, plan and result as jobs; another target uses the samples that there are."""

import shutil

from project import TINY, snakemake

from asperity.results import dataset

NUMBER = "one_and_a_half,lateral=free"
OVERLAY = """
results: results/tiny
seeds: [1]
readings: {lateral: [confined, free]}
ensemble: {nodes: [4, 8], pilot: 4}
"""


def test_a_target_is_reached_and_its_samples_are_kept(tiny_study, tmp_path):
    folder = shutil.copytree(tiny_study.folder, tmp_path / "project")
    (folder / "few_grids.yaml").write_text(OVERLAY)
    made, config = f"results/tiny/ensemble/{NUMBER}", (*TINY, "few_grids.yaml")

    found = snakemake(folder, *config, "--", f"{made}/error0.5/result.nc")
    assert found.returncode == 0, found.stdout + found.stderr
    data = dataset.read(folder / made / "error0.5/result.nc")
    assert 0 < float(data["estimate_total_error"]) < 0.5 * float(data["estimate"])
    assert (folder / made / "error0.5/cost.png").is_file()

    smaller = snakemake(folder, *config, "--dry-run", "--", f"{made}/error0.01/plan1.json")
    assert smaller.returncode == 0, smaller.stdout + smaller.stderr
    assert "rule ensemble_plan" in smaller.stdout.replace("checkpoint", "rule")
    assert "ensemble_samples" not in smaller.stdout
