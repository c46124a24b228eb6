"""``asperity case``: a commented case file for a start, and the explanation of settings."""

import argparse
import json
import sys

from asperity.cli.parser import WRONG_USAGE
from asperity.core.errors import fail
from asperity.engineering import templates
from asperity.engineering.case import Case
from asperity.settings.model import described


def run(options: argparse.Namespace) -> None:
    """Print a template, an explanation, the materials or the JSON Schema."""
    asked = [bool(options.template), bool(options.explain), options.materials, options.schema]
    if sum(asked) != 1:
        known = ", ".join(templates.templates())
        words = f"a template ({known}), or one of --explain, --materials and --schema is needed"
        sys.exit(fail(f"case: {words}", WRONG_USAGE))
    try:
        if options.template:
            text = templates.template(options.template)
        elif options.explain:
            text = f"{templates.explanation(options.explain)}\n"
        elif options.materials:
            text = f"{templates.materials_in_words()}\n"
        else:
            head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
            text = f"{json.dumps(head | dict(described(Case)), ensure_ascii=False, indent=2)}\n"
    except ValueError as error:
        sys.exit(fail(f"case: {error}", WRONG_USAGE))
    print(text, end="")
