"""Cut meshes and soft bodies while they move.

`Mesh` cuts a mesh at rest, `Scene` simulates soft bodies and cuts them as they move. Lengths are in
meters, times in seconds, masses in kilograms. The same input gives the same bits as the Rust
library on every machine and any number of threads.

Refused calls raise `Error`, a `ValueError` whose text says why and what to do.
"""

from ._incise import (
    MODELS,
    CutError,
    CutResult,
    Error,
    FileError,
    FillError,
    FrameStats,
    Mesh,
    RayHit,
    RepairError,
    Scene,
    SceneError,
    TopologyError,
    __version__,
    model,
)
from ._incision import Incision, IncisionState
from ._paper_table import PAPER_TABLE, PaperRow, paper_table

__all__ = [
    "MODELS",
    "PAPER_TABLE",
    "CutError",
    "CutResult",
    "Error",
    "FileError",
    "FillError",
    "FrameStats",
    "Incision",
    "IncisionState",
    "Mesh",
    "PaperRow",
    "RayHit",
    "RepairError",
    "Scene",
    "SceneError",
    "TopologyError",
    "__version__",
    "model",
    "paper_table",
]
