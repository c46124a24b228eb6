"""The elastic solid: layer and half-space, compliance and stress per pressure mode."""
