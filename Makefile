# `make study` and `make test` need nothing but Python: every target first makes its environment, .venv.
PYTHON ?= python3
CORES ?= 2
MINUTES ?=
SEED ?=
CONFIG ?=
RESULTS ?=
PARTS ?=
UPDATE ?=
# Options of snakemake for the study that CONFIG and RESULTS name, by default the paper's.
STUDY = $(if $(CONFIG),--configfile $(CONFIG)) $(if $(RESULTS),--config "results=$(RESULTS)")
FILES = $(CONFIG) $(if $(RESULTS),--results "$(RESULTS)")
FOLDER = $$(python -m asperity.settings results $(FILES))
VENV := .venv
LOCK := requirements.lock
COMPILE = uv pip compile pyproject.toml --custom-compile-command 'make lock' --universal --python-version 3.11 \
	--extra study --extra maps --extra app --extra flow --extra crate --extra build --extra test --generate-hashes --no-emit-index-url --quiet
LINT = ruff check . && ruff format --check . && snakefmt --check Snakefile workflow studies && snakemake --lint && mypy \
	&& lint-imports --no-logo --no-cache
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)

.PHONY: help study quick metadata address theories pages verify test lint check fuzz wheel-test test-oldest test-python unit-tests test-slurm peers peers-tests report crate docs replication bench tradeoff lock clean

help: ## List the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 14

study: $(VENV)/ready ## Make every figure of the paper, in results/figures; CONFIG=mine.yaml RESULTS=folder for a study of your own
	$(if $(CONFIG),python -m asperity.settings check $(FILES))
	snakemake --cores $(CORES) $(STUDY)

quick: $(VENV)/ready ## Run every rule of the study on small cells, into results/quick (a minute and a quarter)
	snakemake --cores $(CORES) --configfile config/quick.yaml

theories: $(VENV)/ready ## Compare theories of rough contact with certified contacts, in studies/theories (four minutes of processor time)
	snakemake --snakefile studies/theories/Snakefile --cores $(CORES)

pages: study theories ## Write the numbers of README, docs, supplement and studies again, and fail if one differs from the commit
	python -m asperity.paper results
	python docs/make_tables.py
	python studies/height_distribution/height_distribution.py
	python studies/nayak/nayak.py
	python studies/master_curve/master_curve.py
	python studies/challenge/challenge.py
	python studies/stability/stability.py
	python benchmarks/tradeoff.py --pages
	python benchmarks/page.py --page
	python benchmarks/film_and_running_in.py
	git diff --exit-code -- '*.md' paper/supplement/claims.csv

verify: $(VENV)/ready ## Compare every result of a study with the manifest of its run; CONFIG=, RESULTS= as for study
	cd "$(FOLDER)" && sha256sum --quiet --check SHA256SUMS

test: $(VENV)/ready ## Run lint and beside it all tests, among them the quick study from nothing (five minutes on two cores)
	@found=$$(mktemp); ($(LINT)) > "$$found" 2>&1 & pytest --numprocesses logical; tests=$$?; \
		wait $$!; lint=$$?; cat "$$found"; rm "$$found"; exit $$((tests || lint))

lint: $(VENV)/ready ## Check style, types, the workflow, and that imports go downwards only
	$(LINT)

check: $(VENV)/ready ## Compare the numbers of the quick study with tests/reference; UPDATE=1 replaces the reference
	python workflow/check.py --cores $(CORES) $(if $(UPDATE),--update)

fuzz: $(VENV)/ready ## Try random input on everything a user calls, for MINUTES=10; SEED=1 repeats a search
	python tests/fuzz/fuzz.py --minutes $(or $(MINUTES),10) $(if $(SEED),--seed $(SEED))

wheel-test: $(VENV)/ready ## Install the wheel in empty environments from the package index and use it, with a small study
	pytest -m wheel tests/wheel

test-oldest: ## Run the unit tests with the oldest versions of all dependencies (tests/requirements-oldest.lock)
	NUMBA_CACHE_DIR="$(CURDIR)/.venv-oldest/machine_code" \
		$(MAKE) VENV=.venv-oldest LOCK=tests/requirements-oldest.lock PYTEST="-W default" unit-tests

test-python: ## Run the unit tests with another Python: make test-python PYTHON=python3.13
	$(MAKE) VENV=.venv-$$($(PYTHON) -c 'import sys; print("%d.%d" % sys.version_info[:2])') unit-tests

unit-tests: $(VENV)/ready
	pytest --numprocesses logical $(PYTEST) tests/unit

test-slurm: $(VENV)/ready ## Run a small study on a SLURM started for it (apt install slurmctld slurmd slurm-client munge)
	pytest -m slurm tests/slurm

peers: ## Compare with aspher, ContactMechanics and tamaas, which it installs (needs cmake, a C++17 compiler and Eigen)
	$(MAKE) VENV=.venv-peers peers-tests

peers-tests: $(VENV)/ready
	pip install --quiet --disable-pip-version-check --editable ".[peers]"
	pytest -m peers tests/physics/test_peers.py

report: study ## Write the study as one page, report.html, and how each file was made, provenance.html; CONFIG=, RESULTS= as for study
	snakemake --cores 1 report_page $(STUDY)
	snakemake --cores 1 $(STUDY) --report "$(FOLDER)/provenance.html"

metadata: $(VENV)/ready ## Write what is made from pyproject.toml, CITATION.cff and the settings: environment, schema and README of the workflow, codemeta.json
	python workflow/metadata.py

address: $(VENV)/ready ## Write the address of the repository into all files that name it: make address URL=https://…
	python workflow/metadata.py --address "$(or $(URL),$(error URL=https://… is needed))"

crate: study ## Describe the results of the study as an RO-Crate, ro-crate-metadata.json among them; CONFIG=, RESULTS= as for study
	python workflow/crate.py "$(FOLDER)" $(if $(CONFIG),--configfile $(CONFIG))

docs: $(VENV)/ready ## Build the documentation site with its gallery, without a network, into docs/_build/html
	MPLBACKEND=Agg python -m sphinx -b html -W --keep-going -n docs docs/_build/html

replication: ## Build the article on what of the paper holds, paper/replication.pdf, in an environment of its own
	$(PYTHON) -m venv .venv-article
	.venv-article/bin/pip install --quiet --disable-pip-version-check --editable ".[article]"
	.venv-article/bin/python paper/replication.py

bench: $(VENV)/ready ## Measure speed and memory in 20 minutes, and write the pages of performance; goes on where it was ended; PARTS="rivals stress" for less
	python benchmarks/page.py $(if $(PARTS),--parts $(PARTS))

tradeoff: $(VENV)/ready ## Measure the errors and times of all settings of accuracy for asperity plan and its page (ten minutes)
	python benchmarks/tradeoff.py

lock: ## Update requirements.lock from pyproject.toml, keeping versions that still fit, and tests/requirements-oldest.lock (needs uv)
	$(COMPILE) --output-file requirements.lock --extra slurm --extra lint --extra docs
	$(COMPILE) --output-file tests/requirements-oldest.lock --resolution lowest-direct

clean: ## Delete the results and the documentation site (the environments stay)
	rm -rf results .snakemake docs/_build docs/api docs/gallery

$(VENV)/ready: $(LOCK)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "Python 3.11 or newer is needed; try: make PYTHON=python3.12 study"; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check --require-hashes --requirement $(LOCK)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@
