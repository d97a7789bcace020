"""Scenes that a seed makes: `random_scenes` of any proportions, `plain_scenes` of ordinary materials."""
