"""The command line ``asperity COMMAND``: single calculations without the study, their pictures and exports.

`main` runs a command and turns errors into one line. `parser` makes the arguments from `commands.yaml` and
the schema of the settings. The module of each command in `commands` is imported when it runs.
"""
