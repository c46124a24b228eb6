# From rough surfaces to the figures of the paper: surface -> contact -> stress -> statistics -> figures.
import sys

try:
    from asperity.errors import ConfigError, PreflightError
    from asperity.runtime.preflight import require_packages

    require_packages()
    from asperity.config.check import check, check_files
    from asperity.config.defaults import complete
    from asperity.config.reader import load
except ImportError as error:
    sys.exit(
        f"study: not installed: {error.name}; install everything with: pip install --requirement requirements.lock"
    )
except PreflightError as error:
    sys.exit(f"study: {error}")


configfile: "config/config.yaml"


report: "workflow/report/overview.rst"


try:
    for path in workflow.configfiles:
        load(path)  # stricter than Snakemake, which has read it: no key is given twice
    check(config)
    check_files(config)
except ConfigError as error:
    sys.exit(f"config: {error}")

config.update(complete(config))

RESULTS = config["results"]
SURFACES = config["surfaces"]


wildcard_constraints:
    surface="|".join(SURFACES),
    seed=r"\d+",


include: "workflow/rules/common.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/resources.smk"
include: "workflow/rules/machine_code.smk"
include: "workflow/rules/surface.smk"
include: "workflow/rules/contact.smk"
include: "workflow/rules/stress.smk"
include: "workflow/rules/statistics.smk"
include: "workflow/rules/validation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/tradeoff.smk"
include: "workflow/rules/handlers.smk"


rule all:
    default_target: True
    input:
        rules.figures.input,
        rules.validation_table.output,
        rules.verified.input,
        rules.claims.output,
        expand(rules.tradeoff.output, extent="reduced"),
