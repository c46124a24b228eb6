"""Stages of the study: surface → contact → stress → statistics, a module each; datasets in, dataset out.

A stage composes the library and writes nothing. Stage validation is `asperity.study.validation`.
"""
