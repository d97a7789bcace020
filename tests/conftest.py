"""Settings that hold for all tests."""

import os

# Many small matrices: threads of the BLAS would only get in each other's way.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from hypothesis import settings  # noqa: E402

# A run on a loaded machine must not fail for its pace, and a failure must come back in the next run.
settings.register_profile("debond", deadline=None, derandomize=True, max_examples=25)
settings.register_profile("random", deadline=None, max_examples=25)  # other cases every time
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "debond"))

os.environ.setdefault("MPLBACKEND", "Agg")
