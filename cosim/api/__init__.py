"""The public names of ``cosim``, for programs and notebooks; ``docs/python.md`` explains them."""
