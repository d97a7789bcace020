"""Commands that solve scenes and compare curves, a module each; a module has the name of its command."""
