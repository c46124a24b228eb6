"""The commands, one module each: ``run(options)`` carries out what the command line asks for.

Their arguments and help are in `commands.yaml` in the folder above.
"""
