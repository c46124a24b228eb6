"""Stages of the study: surface → contact → stress → statistics, a module each; datasets in, dataset out.

A stage composes the library and writes nothing. The module `verification` holds the checks of stage
statistics. Stage validation is `asperity.study.validation`.
"""
