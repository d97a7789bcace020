"""Settings that hold for all tests."""

import os

from hypothesis import settings

# A run on a loaded machine must not fail for its pace, and a failure must come back in the next run.
settings.register_profile("debond", deadline=None, derandomize=True, max_examples=50)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "debond"))

os.environ.setdefault("MPLBACKEND", "Agg")
