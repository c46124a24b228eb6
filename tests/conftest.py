"""Settings of all tests: hypothesis tries the same examples in every run (`make fuzz` tries random ones)."""

from hypothesis import settings

settings.register_profile("deterministic", derandomize=True, deadline=None, database=None)
settings.load_profile("deterministic")
