from .dataset import read_result as read_result
from .dataset import write_result as write_result
