"""The page: edit motion and gains in a browser and see, live, what one range can tell."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: a threaded 8 × 8 solve can stall for 20 ms
