# Many maps of one surface: a job for the answer of each, and then their means. Maps, bodies and load are in a case file
# with a list of maps: snakemake --snakefile workflow/maps.smk --config case=pool.yaml --cores 2
import re
import shlex
import subprocess
import sys

try:
    from asperity.core.errors import InputError, one_line
    from asperity.engineering.case_file import MAP_FILES, at, load_case, names_of_maps
except ImportError as error:
    sys.exit(f"maps: {error}")

if "case" not in config:
    sys.exit("maps: --config case=FILE is needed, a case file with a list of maps")
try:
    POOL = load_case(config["case"])
except InputError as error:
    sys.exit("\n".join(f"maps: {one_line(line)}" for line in error.lines))
FILES = at(POOL, MAP_FILES[0])
if "sample" not in POOL or not isinstance(FILES, list):
    sys.exit(f"maps: {config['case']}: the group `sample` and a list of maps are needed")

CASE, OUT = config["case"], config.get("out", POOL.get("out", "pooled"))
# Files beside each map: the one that it is pressed on, and the constants of materials.
COUNTERS = at(POOL, MAP_FILES[1])
COUNTERS = COUNTERS if isinstance(COUNTERS, list) else [COUNTERS] * len(FILES)
OWN = POOL.get("materials")
OWN = OWN if isinstance(OWN, str) else None  # else the constants are in the case file
READ = [list(filter(None, (*pair, OWN))) for pair in zip(FILES, COUNTERS, strict=True)]
for named in (CASE, OUT, *sum(READ, [])):
    if re.search("[{}]", named):  # Snakemake takes words in braces for wildcards
        sys.exit(f"maps: {named}: a name without braces is needed")
MAPS = dict(zip(names_of_maps(FILES), READ, strict=True))
RUN = [sys.executable, "-m", "asperity", "run", CASE, f"--out={OUT}"]


wildcard_constraints:
    name="|".join(map(re.escape, MAPS)),


# Before the first job: errors of the maps are reported before anything is computed.
onstart:
    if subprocess.run([*RUN, "--check"]).returncode:
        sys.exit(1)


rule sample:
    default_target: True
    input:
        expand(f"{OUT}/{{name}}/answer.csv", name=MAPS),
    output:
        f"{OUT}/sample.csv",
        f"{OUT}/sample.html",
    log:
        f"{OUT}/logs/sample.log",
    shell:
        f"{shlex.join(RUN)} --resume > {{log:q}} 2>&1"


rule answer:
    input:
        CASE,
        lambda wildcards: MAPS[wildcards.name],
    output:
        f"{OUT}/{{name}}/answer.csv",
        f"{OUT}/{{name}}/report.html",
    log:
        f"{OUT}/logs/{{name}}.log",
    shell:
        f"{shlex.join(RUN)} --only={{wildcards.name:q}} > {{log:q}} 2>&1"
