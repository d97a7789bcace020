"""The sections of the report about studies."""
