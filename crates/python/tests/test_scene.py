"""Scenes: motion, cuts in motion, colliders and pins."""

from __future__ import annotations

import contextlib
import threading
from typing import Any

import numpy as np
import pytest

import incise


def edge(x: float) -> Any:
    return [[x, 0.1, -2.0], [x, 0.1, 2.0]]


def ground(height: float) -> Any:
    return {"plane": {"point": [0.0, height, 0.0], "normal": [0.0, 1.0, 0.0]}}


def test_a_weightless_body_stays_where_it_is(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), sleep=False)
    body = scene.add_body(sphere)
    for _ in range(5):
        scene.step()
    np.testing.assert_allclose(scene.positions(body), sphere.vertices, atol=1e-5)
    np.testing.assert_array_equal(scene.faces(body), sphere.faces)


def test_a_free_body_falls_as_in_a_vacuum(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, -10, 0), dt=0.01, substep=0.001)
    body = scene.add_body(sphere, "shell")
    for _ in range(20):
        scene.step()
    fall = (scene.positions(body) - sphere.vertices).mean(axis=0)
    # Implicit Euler with 200 substeps: g h^2 (1 + 2 + ... + 200).
    expected = -10 * 0.001**2 * 200 * 201 / 2
    np.testing.assert_allclose(fall, [0, expected, 0], atol=1e-4)
    velocities = scene.velocities(body)
    np.testing.assert_allclose(velocities.mean(axis=0), [0, -2, 0], atol=1e-3)


def test_a_blade_cuts_a_body_in_motion(sphere: incise.Mesh) -> None:
    scene = incise.Scene()
    scene.set_colliders([ground(-0.5)])
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    assert scene.step().cuts == 0
    before = scene.volume(body)
    scene.move_blade(blade, edge(2))
    stats = scene.step()
    assert (stats.cuts, stats.missed_sweeps, stats.failed_cuts) == (1, 0, 0)
    assert scene.piece_numbers(body) == [0, 1]
    pieces = scene.pieces(body)
    assert all(piece.is_closed for piece in pieces)
    assert sum(piece.volume for piece in pieces) == pytest.approx(scene.volume(body), rel=1e-9)
    assert scene.volume(body) == pytest.approx(before, rel=0.02)
    faces, numbers = scene.faces(body), scene.face_pieces(body)
    assert len(faces) == len(numbers) == sum(len(piece.faces) for piece in pieces)
    assert faces.max() < len(scene.positions(body))
    assert stats.total >= stats.cutting > 0


def test_scenes_repeat_their_bits_on_any_number_of_threads(bunny: incise.Mesh) -> None:
    def run(threads: int) -> bytes:
        scene = incise.Scene(threads=threads)
        scene.set_colliders([ground(-0.5)])
        body = scene.add_body(bunny)
        blade = scene.add_blade(edge(-2))
        for x in (-2, 2, 2):
            scene.move_blade(blade, edge(x))
            scene.step()
        return scene.positions(body).tobytes()

    assert run(1) == run(2) == run(1)


def test_a_failed_cut_is_reported(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2), "full-slices")
    scene.move_blade(blade, edge(0.01))
    assert scene.step().failed_cuts == 1
    [(failed_blade, failed_body, reason)] = scene.failed_cuts
    assert (failed_blade, failed_body) == (blade, body)
    assert "ends inside the body" in reason


def test_a_blade_may_stop_inside_and_go_on(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    for x, pieces in ((0.01, 1), (2.0, 2)):
        scene.move_blade(blade, edge(x))
        assert scene.step().cuts == 1
        assert len(scene.piece_numbers(body)) == pieces


def test_an_incision_tells_where_its_blade_is(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    state = incise.IncisionState
    assert scene.incision(blade, body) == (state.OUTSIDE, 0)
    for x, y, expected in [
        (0.01, 0.1, state.INSIDE),
        (2.0, 0.1, state.FINISHED),
        (-2.0, 0.3, state.OUTSIDE),
        (0.01, 0.3, state.INSIDE),
        (-1.5, 1.2, state.ABANDONED),
    ]:
        move = scene.teleport_blade if expected is state.OUTSIDE else scene.move_blade
        move(blade, [[x, y, -2.0], [x, y, 2.0]])
        scene.step()
        assert scene.incision(blade, body) == incise.Incision(expected, refused_steps=0)
    assert scene.incision(blade, body).state == "abandoned"


def test_a_teleported_blade_cuts_nothing(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    scene.teleport_blade(blade, edge(2))
    assert scene.step().sweeps == 0


def test_colliders_hold_a_body(sphere: incise.Mesh) -> None:
    plane = {"plane": {"point": [0, -0.5, 0], "normal": [0, 1, 0]}}
    for shapes in ([plane], [{"box": {"center": [0, -1.0, 0], "half": [2, 0.5, 2]}}]):
        scene = incise.Scene()
        scene.set_colliders(shapes)
        body = scene.add_body(sphere)
        for _ in range(30):
            scene.step()
        assert scene.positions(body)[:, 1].min() > -0.51


def test_pinned_vertices_follow_their_targets(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), sleep=False)
    body = scene.add_body(sphere, "cloth", stretch={"compliance": 1e-4})
    scene.pin(body, 3)
    target = sphere.vertices[3] + np.float32(0.25)
    scene.set_pin_target(body, 3, target)
    scene.step()
    np.testing.assert_array_equal(scene.positions(body)[3], target)
    scene.unpin(body, 3)
    with pytest.raises(incise.SceneError, match="pin"):
        scene.unpin(body, 3)


def test_velocities_move_a_body(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    body = scene.add_body(sphere, "limp-shell", damping=0.0)
    scene.set_velocities(body, np.tile([0.6, 0.0, 0.0], (len(sphere.vertices), 1)))
    scene.step(dt=0.1)
    moved = scene.positions(body) - sphere.vertices
    np.testing.assert_allclose(moved.mean(axis=0), [0.06, 0, 0], atol=1e-4)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"density": {"per_area": -1.0}}, "density"),
        ({"density": {"per_liter": 1.0}}, "per_liter"),
        ({"stretch": {"stiffness": 2.0}}, "stiffness"),
        ({"stretch": {"stiffness": 1.0, "compliance": 0.0}}, "it must be one of { stiffness"),
        ({"friction": float("nan")}, "friction"),
        ({"material": "steel"}, "soft-body"),
    ],
)
def test_bad_materials_are_refused(sphere: incise.Mesh, keys: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Scene().add_body(sphere, **keys)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"dt": 0.0}, "dt is 0"),
        ({"iterations": 0}, "iteration"),
        ({"gravity": [0, 0]}, "it must be 3 numbers"),
        ({"residual": float("inf")}, "residual"),
        ({"contacts": {"thickness": -1.0}}, "thickness"),
        ({"contacts": {"depth": 1.0}}, "depth"),
        ({"level": "finest"}, "level is 'finest'"),
    ],
)
def test_bad_parameters_of_scenes_are_refused(keys: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Scene(**keys)


def test_a_bad_time_step_changes_nothing(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), dt=0.01)
    scene.add_body(sphere)
    for dt in (0.0, -1.0, float("nan")):
        with pytest.raises(incise.SceneError, match="dt is"):
            scene.step(dt=dt)
    scene.step()


@pytest.mark.parametrize("other", [0.0, 1e-30, 1.0, 1e30, 3e38, 1e300])
def test_no_time_step_of_a_frame_stays(sphere: incise.Mesh, other: float) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), dt=1 / 60, sleep=False)
    body = scene.add_body(sphere, "limp-shell", damping=0.0)
    with contextlib.suppress(incise.Error):
        scene.step(dt=other)
    before = scene.positions(body)
    scene.set_velocities(body, np.tile([0.6, 0.0, 0.0], (len(sphere.vertices), 1)))
    scene.step()
    moved = scene.positions(body) - before
    np.testing.assert_allclose(moved.mean(axis=0), [0.01, 0, 0], atol=1e-5)


def test_unknown_numbers_are_refused(sphere: incise.Mesh) -> None:
    scene = incise.Scene()
    for call in (
        lambda: scene.positions(0),
        lambda: scene.move_blade(0, edge(0)),
        lambda: scene.set_blade_face(0, None),
        lambda: scene.incision(0, 0),
    ):
        with pytest.raises(incise.SceneError, match="does not exist"):
            call()
    body = scene.add_body(sphere)
    with pytest.raises(incise.SceneError, match="vertex 386 does not exist"):
        scene.pin(body, len(sphere.vertices))
    with pytest.raises(incise.Error, match="shape"):
        scene.set_velocities(body, [[0, 0, 0]])
    with pytest.raises(incise.Error, match=r"colliders\[0\]"):
        scene.set_colliders([{"sphere": {"center": [0, 0, 0], "radius": -1.0}}])


def test_other_threads_run_during_a_step(bunny: incise.Mesh) -> None:
    """A step of many substeps must not hold the interpreter: the thread would never start."""
    scene = incise.Scene(substep=1 / 120_000)
    scene.add_body(bunny)
    is_stepping, counted = threading.Event(), [0]

    def count() -> None:
        is_stepping.wait()
        while is_stepping.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    is_stepping.set()
    before = counted[0]
    scene.step()
    after = counted[0]
    is_stepping.clear()
    thread.join()
    assert after > before + 1000


def test_the_table_has_the_paper_beside_it() -> None:
    rows = incise.paper_table(["sphere20", "Sphere80"], seconds=1.5)
    assert [row["model"] for row in rows] == ["Sphere20", "Sphere80"]
    for row in rows:
        assert row["cuts"] == 1 and row["cuts_refused"] == []
        assert row["triangles_after"] > row["triangles"]
        assert row["pbd_fps"] > 0 and row["pbd_cs_fps"] > 0
    assert rows[1]["paper_cut_ms"] == 12.66
    with pytest.raises(incise.Error, match="seconds"):
        incise.paper_table(["Sphere20"], seconds=0)
