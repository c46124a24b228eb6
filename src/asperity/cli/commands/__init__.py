"""The commands, one module each: ``run(options)`` carries out what the command line asks for."""
