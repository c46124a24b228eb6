# From rough surfaces to the figures of the paper: surface -> contact -> stress -> statistics -> figures.
import sys

try:
    from asperity.core.packages import require

    require()
    from asperity.core.errors import ConfigError
    from asperity.study.config.study import read_study
except ImportError as error:
    sys.exit(f"study: {error}")


report: "workflow/report/overview.rst"


# Not by `configfile`: a configuration on the command line stands alone, and is read more strictly than by Snakemake.
# The two attributes hold what --configfile and --config give.
try:
    study = read_study([*map(str, workflow.overwrite_configfiles)], workflow.config_settings.config)
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


include: "workflow/rules/code.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/resources.smk"
include: "workflow/rules/stages.smk"
include: "workflow/rules/validation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/handlers.smk"


rule all:
    default_target: True
    input:
        # Results that are lost are made again, also those that only others are made from.
        STAGE_RESULTS,
        rules.figures.input,
        rules.validation.output if config["validation"] else [],
        rules.claims.output if config["claims"] else [],


include: "workflow/rules/report_page.smk"
