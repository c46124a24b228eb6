from .answer import Answer as Answer
from .answer_numbers import BodyAnswer as BodyAnswer
from .case import Body as Body
from .case import Case as Case
from .case import CounterMap as CounterMap
from .case import Load as Load
from .output import write_answer as write_answer
from .run import run as run
