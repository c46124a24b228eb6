"""The command ensemble: pilot, plan and result as jobs of the study; more accuracy keeps what there is."""

import sys

from project import run

from asperity.results import dataset

CLAIM = "one_and_a_half"
OVERLAY = "results: results/tiny\nensemble: {nodes: [4, 8], pilot: 4}\n"


def ensemble(folder, *arguments):
    files = ("config/quick.yaml", "tests/workflow/tiny.yaml", "few_grids.yaml")
    command = (sys.executable, "-m", "asperity.cli", "ensemble", "--claim", CLAIM, "--config", *files)
    found = run(folder, *command, *arguments)
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


def samples(folder):
    return {path: path.stat().st_mtime_ns for path in folder.glob("results/tiny/ensemble/samples/**/*.nc")}


def test_more_accuracy_adds_to_the_samples(tiny_study):
    folder = tiny_study.folder
    (folder / "few_grids.yaml").write_text(OVERLAY)

    plan = ensemble(folder, "--error", "50%", "--plan")
    assert "bias" in plan
    assert not list(folder.glob(f"results/tiny/ensemble/{CLAIM}/error0.5/result.nc"))
    pilot = samples(folder)
    assert pilot

    told = ensemble(folder, "--error", "50%")
    assert "plain Monte Carlo on 8 nodes" in told
    assert samples(folder) == pilot
    loose = dataset.read(folder / f"results/tiny/ensemble/{CLAIM}/error0.5/result.nc")

    share = 0.8 * float(loose["estimate_error"]) / float(loose["estimate"])
    ensemble(folder, "--error", f"{share:.6g}")
    more = samples(folder)
    assert more.keys() > pilot.keys()
    assert {path: more[path] for path in pilot} == pilot
    tight = dataset.read(next(folder.glob(f"results/tiny/ensemble/{CLAIM}/error0.0*/result.nc")))
    assert float(tight["estimate_error"]) < float(loose["estimate_error"])
    assert abs(float(tight["estimate"] - loose["estimate"])) < 4 * float(loose["estimate_error"])
