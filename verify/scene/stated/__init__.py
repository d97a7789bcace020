"""What a scene states beside its problem: values that others published, and how well its numbers are known."""
