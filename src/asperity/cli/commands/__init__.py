"""The commands, one module each: ``run(options)`` carries out the command.

Their arguments and help are in `commands.yaml` in the folder above.
"""
