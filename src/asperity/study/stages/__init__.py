"""Stages of the study: surface → contact → stress → statistics, a module each; datasets in, dataset out.

A stage composes the library and writes nothing. The modules `seed_numbers` and `verification` hold the
numbers and checks of stage statistics. Stage validation is `asperity.study.validation`.
"""
