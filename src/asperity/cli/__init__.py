"""The command line ``asperity surface | solve | stress | peaks | plot | plan | view | export``: single calculations without the study.

`main` runs a command and turns errors into one line. `parser` describes the commands, with `arguments` made
from the schema of the settings. The module of each command in `commands` is imported when it runs.
"""
