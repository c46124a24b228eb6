from .answer import Answer as Answer
from .answer import BodyAnswer as BodyAnswer
from .case import Body as Body
from .case import Case as Case
from .case import Load as Load
from .indenter import MapSettings as MapSettings
from .output import write_answer as write_answer
from .run import run as run
