"""The commands, a file each: options, output, scenes to start from, shell completion."""
