"""The elastic solid: a layer or a half-space, its compliance, stress and displacement per pressure mode."""
