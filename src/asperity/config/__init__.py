"""The configuration of the study: schema, reader, presets."""
