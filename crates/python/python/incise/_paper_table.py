"""The paper's Table 1 as a loop over `Scene`."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Optional, TypedDict

import numpy as np
import numpy.typing as npt

from ._incise import MODELS, Error, Mesh, Scene, model

PAPER_TABLE: dict[str, tuple[float, float, float, float]] = {
    "Sphere20": (231.8, 205.9, 11.17, 11.33),
    "Sphere80": (231.3, 177.2, 23.39, 12.66),
    "Sphere768": (158.6, 108.4, 31.65, 21.66),
    "Bunny": (135.6, 79.9, 41.08, 29.33),
    "Octopus": (103.2, 51.7, 49.9, 38.0),
    "Banana": (72.9, 32.1, 55.97, 80.0),
    "Armadillo": (9.9, 5.2, 47.47, 239.33),
}
"""The paper's numbers: PBD FPS, PBD+CS FPS, difference [%] and time of a cut [ms]."""

_FRAMES_A_SECOND = 60
# Distance of the idle blade from the body [diagonals of its box].
_HOVER = 100.0
# Initial motion of the body: angular velocity about y, and rate of a squeeze along y [1/s].
_SPIN, _SQUEEZE = 1.0, 0.25


class PaperRow(TypedDict):
    """One row of the table, beside the paper's numbers for the model."""

    model: str
    vertices: int
    triangles: int
    triangles_after: int
    pbd_fps: float
    pbd_cs_fps: float
    fps_difference_percent: float
    cut_ms_mean: float
    cuts: int
    cuts_refused: list[str]
    paper_pbd_fps: float
    paper_pbd_cs_fps: float
    paper_fps_difference_percent: float
    paper_cut_ms: float


def paper_table(
    models: Optional[Iterable[str]] = None,
    *,
    seconds: float = 15.0,
    level: str = "original",
    seed: int = 1,
) -> list[PaperRow]:
    """Runs the paper's protocol on built-in models and returns a row for each.

    Two runs of `seconds` simulated seconds: the solver alone (PBD), and with a blade that slices
    the largest piece once a second (PBD+CS). The scene is weightless and has the paper's solver,
    one substep of ten projections. Frame rates count wall time of `Scene.step`.

    This is a loop over `Scene`, not `incise-bench table` itself, whose program is no part of the
    wheel: seeded directions differ, so do the cuts, and errors are not measured. Large models take
    a while: 15 seconds of Armadillo are 1,800 frames.
    """
    names = list(MODELS if models is None else models)
    frames = round(seconds * _FRAMES_A_SECOND)
    if frames < 1:
        raise Error("seconds is shorter than half a frame; pass a larger number")
    return [_row(model(name), name, frames, level, seed) for name in names]


def _row(mesh: Mesh, name: str, frames: int, level: str, seed: int) -> PaperRow:
    name = next(known for known in MODELS if known.lower() == name.lower())
    mesh = mesh.sort_by_position()
    pbd = _Run(mesh, level)
    for frame in range(frames):
        pbd.frame(frame, None)
    cs = _Run(mesh, level)
    directions = np.random.default_rng(seed)
    # A failed slice is repeated in the next frame with the next direction.
    due = False
    for frame in range(1, frames + 1):
        due |= frame % _FRAMES_A_SECOND == 0
        done = cs.frame(frame, directions if due else None)
        due &= not done
    pbd_fps, cs_fps = frames / pbd.seconds, frames / cs.seconds
    paper = PAPER_TABLE[name]
    return {
        "model": name,
        "vertices": len(mesh.vertices),
        "triangles": len(mesh.faces),
        "triangles_after": len(cs.scene.faces(cs.body)),
        "pbd_fps": pbd_fps,
        "pbd_cs_fps": cs_fps,
        "fps_difference_percent": (1.0 - cs_fps / pbd_fps) * 100.0,
        "cut_ms_mean": float(np.mean(cs.cut_ms)) if cs.cut_ms else float("nan"),
        "cuts": len(cs.cut_ms),
        "cuts_refused": cs.refused,
        "paper_pbd_fps": paper[0],
        "paper_pbd_cs_fps": paper[1],
        "paper_fps_difference_percent": paper[2],
        "paper_cut_ms": paper[3],
    }


class _Run:
    """A body in motion, and a blade that hovers far away until it slices."""

    def __init__(self, mesh: Mesh, level: str) -> None:
        self.scene = Scene(
            iterations=5,
            substep=None,
            lift=0.0,
            conserve=False,
            diagonal_scale=1.0,
            attachments=False,
            gravity=(0.0, 0.0, 0.0),
            sleep=False,
            skip_far_sweeps=False,
            level=level,
        )
        self.body = self.scene.add_body(mesh, "limp-shell", bending={"stiffness": 0.5})
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self.diagonal = float(np.linalg.norm(high - low))
        r = mesh.vertices - (low + high) / 2
        motion = np.stack([_SPIN * r[:, 2], -_SQUEEZE * r[:, 1], -_SPIN * r[:, 0]], axis=1)
        self.scene.set_velocities(self.body, motion)
        self.blade: Optional[int] = None
        self.seconds = 0.0
        self.cut_ms: list[float] = []
        self.refused: list[str] = []

    def frame(self, frame: int, directions: Optional[np.random.Generator]) -> bool:
        """Steps, and slices the largest piece if there are directions. Returns whether it did."""
        if frame > 0:
            self._place_blade(frame, directions)
        begin = time.perf_counter()
        stats = self.scene.step()
        self.seconds += time.perf_counter() - begin
        if directions is None or self.blade is None:
            return False
        self.cut_ms += [stats.cutting * 1e3] * stats.cuts
        self.refused += [reason for _, _, reason in self.scene.failed_cuts]
        self.scene.teleport_blade(self.blade, self._hover(frame))
        self.scene.set_blade_piece(self.blade, None)
        return stats.cuts > 0

    def _place_blade(self, frame: int, directions: Optional[np.random.Generator]) -> None:
        if self.blade is None:
            self.blade = self.scene.add_blade(self._hover(0), "full-slices")
        if directions is None:
            self.scene.move_blade(self.blade, self._hover(frame))
            return
        pieces = self.scene.pieces(self.body)
        volumes = [abs(piece.volume) for piece in pieces]
        largest = int(np.argmax(volumes))
        points = pieces[largest].vertices
        normal = directions.normal(size=3)
        normal /= np.linalg.norm(normal)
        along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        along /= np.linalg.norm(along)
        reach = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
        edge = points.mean(axis=0) + np.outer([-reach, reach], along)
        motion = np.cross(normal, along) * reach
        self.scene.teleport_blade(self.blade, edge - motion)
        piece = self.scene.piece_numbers(self.body)[largest]
        self.scene.set_blade_piece(self.blade, piece)
        self.scene.move_blade(self.blade, edge + motion)

    def _hover(self, frame: int) -> npt.NDArray[np.float64]:
        angle = 0.1 * frame
        out = np.array([np.cos(angle), 0.0, np.sin(angle)]) * _HOVER * self.diagonal
        along = np.array([0.0, self.diagonal / 2, 0.0])
        return np.stack([out - along, out + along])
