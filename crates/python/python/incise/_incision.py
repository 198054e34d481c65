"""Incisions: blades that stop inside bodies and go on from there."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class IncisionState(str, Enum):
    """Where a blade is after its last step in a body."""

    OUTSIDE = "outside"
    """Outside of the body, and it has cut nothing since it was inside."""
    INSIDE = "inside"
    """At the tip of its cut in the body, or behind it on the way in, which begins outside."""
    BLOCKED = "blocked"
    """Ahead of the tip, because the last step was refused. It is tried again from the same tip."""
    FINISHED = "finished"
    """Outside, and its cut is complete."""
    ABANDONED = "abandoned"
    """Outside, and the tip of its cut is in the body."""


class Incision(NamedTuple):
    """The incision of a blade in a body, see `Scene.incision`."""

    state: IncisionState
    """Where the blade is after its last step."""
    refused_steps: int
    """Number of refused steps since the last one that cut."""
