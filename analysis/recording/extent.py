"""Which road users a run records."""

from __future__ import annotations

EGOS = "egos"
"""Egos and the road users near them."""
EVERYBODY = "everybody"
"""The traffic near crossings as well; such a run needs no ego."""
