"""Who met whom, when, where and how: what metrics are computed from."""
