"""The page: what a visitor chooses, what is computed from it, and how it is shown."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: a threaded 8 × 8 solve can stall for 20 ms
