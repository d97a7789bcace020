"""The commands: options, output, scene templates, shell completion."""
