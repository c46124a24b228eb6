"""From a measured map, two materials and a load to the answer of an engineer, in SI units.

`run` carries out all stages and returns an `Answer`: real contact, pressures, largest stress with its depth
and place, volume above yield, and the advice of an experienced colleague. `write_answer` writes result files,
pictures, tables and a report page into a folder.
"""

from asperity.engineering.answer import Answer, BodyAnswer
from asperity.engineering.case import Body, Case, Load
from asperity.engineering.output import write_answer
from asperity.engineering.run import run

__all__ = ["Answer", "Body", "BodyAnswer", "Case", "Load", "run", "write_answer"]
