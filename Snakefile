# From rough surfaces to the figures of the paper: surface -> contact -> stress -> statistics -> figures.
import sys

try:
    from asperity.errors import ConfigError, PreflightError
    from asperity.runtime.preflight import require_packages

    require_packages()
    from asperity.runtime.interrupts import end_study_with_jobs
    from asperity.runtime.snakemake_internals import is_main_process

    if is_main_process(workflow):
        end_study_with_jobs()
    from asperity.config.study import read_study
    from asperity.runtime.snakemake_internals import overlays, settings_given
except ImportError as error:
    sys.exit(f'study: not installed: {error.name}; install with: pip install "asperity[study]"')
except PreflightError as error:
    sys.exit(f"study: {error}")


report: "workflow/report/overview.rst"


# Not by `configfile`: a configuration on the command line stands alone, and is read more strictly than by Snakemake.
try:
    study = read_study(overlays(workflow), settings_given(workflow))
except ConfigError as error:
    sys.exit(f"config: {error}")

config.clear()
config.update(study)

RESULTS = config["results"]
SURFACES = config["surfaces"]
MEASURED = config["measured"]


wildcard_constraints:
    surface="|".join([*SURFACES, *MEASURED]),
    seed=r"\d+",


include: "workflow/rules/common.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/ensemble_inputs.smk"
include: "workflow/rules/resources.smk"
include: "workflow/rules/machine_code.smk"
include: "workflow/rules/fft_wisdom.smk"
include: "workflow/rules/surface.smk"
include: "workflow/rules/contact.smk"
include: "workflow/rules/stress.smk"
include: "workflow/rules/statistics.smk"
include: "workflow/rules/validation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/tradeoff.smk"
include: "workflow/rules/ensemble.smk"
include: "workflow/rules/handlers.smk"


rule all:
    default_target: True
    input:
        # Results that are lost are made again, also those that only others are made from.
        STAGE_RESULTS,
        rules.figures.input,
        rules.validation_table.output if VALIDATIONS else [],
        rules.verified.input,
        rules.claims.output if config["claims"] else [],
        [*rules.ensemble.output, *rules.ensemble_gains.output] if ENSEMBLE["claims"] else [],
        expand(rules.tradeoff.output, extent=["reduced"] if "reduced" in config["tradeoff"] else []),


include: "workflow/rules/report_page.smk"
