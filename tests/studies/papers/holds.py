"""Statuses of claims that need no reason, for they hold as the paper has them."""

from __future__ import annotations

from studies.papers.claim import Status

HOLDS = frozenset({Status.RESULT, Status.ARITHMETIC, Status.OWN_CHECK})
