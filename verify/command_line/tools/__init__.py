"""Commands around the studies: other formats, scenes, the shell, the installation; a module each."""
