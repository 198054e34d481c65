"""Drops a soft body on the ground and cuts it on the way.

    python soft_body.py
"""

from __future__ import annotations

import numpy as np

import incise


def main() -> None:
    scene = incise.Scene(contacts=True)
    scene.set_colliders([{"plane": {"point": [0, -0.8, 0], "normal": [0, 1, 0]}}])
    body = scene.add_body(incise.model("Sphere768"), "soft-body", friction=0.8)
    edge = np.array([[0.05, 1.0, -1.0], [0.05, 1.0, 1.0]])
    blade = scene.add_blade(edge)
    for frame in range(60):
        if frame == 10:
            scene.move_blade(blade, edge - [0.0, 3.0, 0.0])
        stats = scene.step()
        if stats.cuts or frame % 20 == 19:
            height = scene.positions(body)[:, 1].mean()
            pieces = len(scene.piece_numbers(body))
            print(
                f"frame {frame}: mean height {height:.3f} m, {pieces} pieces, "
                f"volume {scene.volume(body):.4f} m^3, {stats.total * 1e3:.2f} ms"
            )


if __name__ == "__main__":
    main()
