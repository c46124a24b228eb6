# The two commands are `make study` and `make test`; each makes its own environment first.
PYTHON ?= python3
CORES ?= 2
VENV := .venv
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)

.PHONY: help study quick test test-faults test-slurm bad-input lint check report bench tradeoff calculix clean

help: ## What can be made
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 14

study: $(VENV)/ready ## The paper: every figure of the study, in results/figures; CONFIG=overlay.yaml changes it
	$(if $(CONFIG),python -m asperity.config check config/config.yaml $(CONFIG))
	snakemake --cores $(CORES) $(if $(CONFIG),--configfile $(CONFIG))

quick: $(VENV)/ready ## Every stage and every rule on a small cell, in results/quick
	snakemake --cores $(CORES) --configfile config/quick.yaml

test: lint ## Everything that is checked: lint, unit and physics tests, the quick study from clean
	pytest

test-slurm: $(VENV)/ready ## The quick study on a SLURM started for it (apt install slurmctld slurmd slurm-client munge)
	pytest -m slurm tests/slurm

lint: $(VENV)/ready ## Style, types, workflow
	ruff check .
	ruff format --check .
	snakefmt --check Snakefile workflow
	python workflow/lint.py
	mypy

check: $(VENV)/ready ## Whether the numbers of the quick study are those in tests/reference; UPDATE=1 rewrites them
	python workflow/check.py --cores $(CORES) $(if $(UPDATE),--update)

report: study ## The study as one page, results/report.html, that needs no network
	snakemake --cores 1 --report results/report.html

bad-input: $(VENV)/ready ## Wrong configurations, command lines and height maps, and the line each is answered with
	python tests/unit/bad_input.py

test-faults: $(VENV)/ready ## A small study killed fifty times and run again, as a table in results/faults.md
	python tests/workflow/faults.py --kills 50

bench: $(VENV)/ready ## Speed and accuracy of the layer, the contact solvers and the stress, peers beside them where installed
	python benchmarks/layer.py
	python benchmarks/contact.py
	python benchmarks/gfmd.py
	python benchmarks/stress.py
	python benchmarks/economies.py

tradeoff: $(VENV)/ready ## Errors and costs of all settings of accuracy, measured anew for asperity plan and config/README.md
	python workflow/store_tradeoff.py

calculix: $(VENV)/ready ## The slab by CalculiX too (which must be installed), and the validation table with it
	snakemake --cores $(CORES) results/validation/calculix.nc
	snakemake --cores $(CORES) --forcerun validation_table -- results/validation/table.md

clean: ## Remove results (the environment stays)
	rm -rf results .snakemake

$(VENV)/ready: requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "Python 3.11 or newer is needed; try: make PYTHON=python3.12 study"; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements.lock
	$(VENV)/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@
