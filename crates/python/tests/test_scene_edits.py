"""Scenes: undo, removal, rays, changes of parameters and materials, saving and copies."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest

import incise

NAN, INF = float("nan"), float("inf")


def edge(x: float, y: float = 0.1) -> Any:
    return [[x, y, -2.0], [x, y, 2.0]]


def ground(height: float) -> Any:
    return {"plane": {"point": [0.0, height, 0.0], "normal": [0.0, 1.0, 0.0]}}


def slice_body(scene: incise.Scene, blade: int, y: float) -> None:
    scene.teleport_blade(blade, edge(-2, y))
    scene.move_blade(blade, edge(2, y))
    assert scene.step().cuts == 1


def test_cuts_are_undone_to_the_bit(bunny: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    body = scene.add_body(bunny)
    blade = scene.add_blade(edge(-2))
    before = scene.faces(body)
    for y in (0.1, -0.05):
        slice_body(scene, blade, y)
    assert scene.undo_count() == scene.undo_count(body) == 2
    pieces = scene.piece_numbers(body)
    scene.undo(body)
    assert 1 < len(scene.piece_numbers(body)) < len(pieces)
    scene.undo()
    np.testing.assert_array_equal(scene.faces(body), before)
    assert scene.piece_numbers(body) == [0]
    with pytest.raises(incise.Error, match="no cut to undo"):
        scene.undo()
    with pytest.raises(incise.SceneError, match="body 0 has no cut"):
        scene.undo(body)
    scene.step()


def test_only_the_last_cuts_are_kept(bunny: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), undo_limit=1)
    scene.add_body(bunny)
    blade = scene.add_blade(edge(-2))
    for y in (0.1, -0.05):
        slice_body(scene, blade, y)
    assert scene.undo_count() == 1
    scene.set_params(undo_limit=0)
    assert scene.undo_count() == 0


def test_a_removed_body_is_gone_and_the_others_keep_their_numbers(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0))
    first, second = scene.add_body(sphere), scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    scene.move_blade(blade, edge(2))
    assert scene.step().cuts == 2
    scene.remove_body(first)
    assert scene.bodies == [second] and scene.undo_count() == 1
    with pytest.raises(incise.SceneError, match="body 0 does not exist"):
        scene.positions(first)
    assert scene.add_body(sphere) == 2
    loaded = incise.Scene.load(scene.save())
    assert loaded.bodies == [1, 2]
    np.testing.assert_array_equal(loaded.positions(second), scene.positions(second))


def test_a_ray_hits_the_nearest_face(sphere: incise.Mesh) -> None:
    scene = incise.Scene()
    body = scene.add_body(sphere)
    hit = scene.cast_ray(body, [0.1, 0.05, 5], [0, 0, -2])
    assert hit is not None and not hit.from_inside
    corners = scene.positions(body)[scene.faces(body)[hit.face]].astype(np.float64)
    np.testing.assert_allclose(np.asarray(hit.weights) @ corners, hit.point, atol=1e-6)
    np.testing.assert_allclose(hit.point, [0.1, 0.05, 5 - 2 * hit.distance])
    assert hit.point[2] > 0.4
    nearest = scene.faces(body)[hit.face][np.argmax(hit.weights)]
    assert hit.vertex == nearest
    assert scene.cast_ray(body, [2, 2, 5], [0, 0, -1]) is None


def test_changed_parameters_are_those_of_a_new_scene(sphere: incise.Mesh) -> None:
    new: Any = {"dt": 0.01, "substep": 0.0025, "iterations": 2, "gravity": [0, -1, 0]}
    changed, made = incise.Scene(), incise.Scene(**new)
    changed.set_params(**new)
    for scene in (changed, made):
        scene.set_colliders([ground(-0.51)])
        scene.add_body(sphere)
        for _ in range(20):
            scene.step()
    np.testing.assert_array_equal(changed.positions(0), made.positions(0))


def test_absent_parameters_stay(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), level="2x-coarser")
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    coarse = incise.Scene(gravity=(0, 0, 0), level="2x-coarser", snap=0.2)
    coarse.add_body(sphere)
    coarse.add_blade(edge(-2))
    scene.set_params(snap=0.2)
    for each in (scene, coarse):
        slice_body(each, blade, 0.1)
    np.testing.assert_array_equal(scene.positions(body), coarse.positions(body))
    assert abs(scene.positions(body)[:, 1].mean()) < 0.1, "no gravity"


def test_a_refused_parameter_changes_nothing(sphere: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), dt=0.01)
    body = scene.add_body(sphere)
    before = scene.save()
    with pytest.raises(incise.Error, match="substep"):
        scene.set_params(dt=0.5, gravity=(0, -9, 0), substep=0)
    assert scene.save() == before
    with pytest.raises(incise.SceneError, match="friction"):
        scene.set_material(body, damping=1.0, friction=-1.0)
    with pytest.raises(incise.SceneError, match="the density of a body cannot be changed"):
        scene.set_material(body, density={"per_area": 2.0})
    with pytest.raises(incise.SceneError, match="bending"):
        scene.set_material(body, bending=None)
    scene.step()


def test_a_changed_material_is_that_of_a_new_body(sphere: incise.Mesh) -> None:
    positions = []
    oiled: Any = {"damping": 5.0, "friction": 0.0}
    for first, then in (({}, oiled), (oiled, {})):
        scene = incise.Scene()
        scene.set_colliders([ground(-0.55)])
        body = scene.add_body(sphere, "soft-body", **first)
        scene.set_material(body, **then)
        for _ in range(20):
            scene.step()
        positions.append(scene.positions(body))
    np.testing.assert_array_equal(positions[0], positions[1])


def test_a_loaded_scene_goes_on_with_the_same_bits(bunny: incise.Mesh) -> None:
    scene = incise.Scene(contacts=True)
    scene.set_colliders([ground(-0.5)])
    body = scene.add_body(bunny)
    blade = scene.add_blade(edge(-2))
    slice_body(scene, blade, 0.1)
    others = [incise.Scene.load(scene.save()), copy.deepcopy(scene)]
    others.append(pickle.loads(pickle.dumps(scene)))
    for each in (scene, *others):
        each.move_blade(blade, edge(-2, 0.12))
        for _ in range(10):
            each.step()
        assert each.positions(body).tobytes() == scene.positions(body).tobytes()
    for bad in (b"", b"incise", scene.save()[:-9]):
        with pytest.raises(incise.FileError):
            incise.Scene.load(bad)


def test_copies_keep_the_undo_limit(bunny: incise.Mesh) -> None:
    scene = incise.Scene(gravity=(0, 0, 0), undo_limit=1)
    scene.add_body(bunny)
    blade = scene.add_blade(edge(-2))
    others = [copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))]
    others += [incise.Scene.load(scene.save(), undo_limit=1), incise.Scene.load(scene.save())]
    for each, count in zip(others, (1, 1, 1, 1, 2)):
        for y in (0.1, -0.05):
            slice_body(each, blade, y)
        assert each.undo_count() == count


def test_a_scene_is_loaded_from_any_bytes(sphere: incise.Mesh) -> None:
    scene = incise.Scene()
    scene.add_body(sphere)
    saved = scene.save()
    for data in (bytearray(saved), memoryview(saved), memoryview(b"x" + saved)[1:]):
        assert incise.Scene.load(data).save() == saved
    for bad in (3, "text", None, [1, 2]):
        with pytest.raises(TypeError):
            incise.Scene.load(bad)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("shape", "text"),
    [
        ({"sphere": 3}, r"colliders\[1\]\['sphere'\] is no dict; pass {'center': .*'radius'"),
        ({"sphere": {"radius": 1.0}}, r"\['sphere'\] has no center; pass {'center'"),
        ({"box": {"center": [0, 0, 0], "half": [1, 1, 1], "size": 2}}, "unknown key 'size'"),
        ({"plane": {"point": [0, 0, 0], "normal": [0, 1, 0], "axes": 2}}, "unknown key 'axes'"),
        ({"cone": {}}, "unknown key 'cone'"),
        ({"sphere": {"center": [0, 0, 0], "radius": NAN}}, "no solid shape"),
    ],
)
def test_bad_colliders_are_refused(shape: Any, text: str) -> None:
    good = {"sphere": {"center": [0, -5, 0], "radius": 1.0}}
    with pytest.raises(incise.Error, match=text):
        incise.Scene().set_colliders([good, shape])


@pytest.mark.parametrize("number", [-1, -(2**70), 2**64, 2**70, 7])
def test_numbers_of_no_object_are_errors(sphere: incise.Mesh, number: int) -> None:
    scene = incise.Scene()
    body, blade = scene.add_body(sphere), scene.add_blade(edge(-2))
    number = number * 1000
    for call in (
        lambda: scene.positions(number),
        lambda: scene.pin(body, number),
        lambda: scene.pin(number, 0),
        lambda: scene.set_pin_target(body, number, [0, 0, 0]),
        lambda: scene.move_blade(number, edge(0)),
        lambda: scene.set_blade_face(number, None),
        lambda: scene.undo(number),
        lambda: scene.undo_count(number),
        lambda: scene.remove_body(number),
    ):
        with pytest.raises(incise.SceneError, match=f"{number} does not exist"):
            call()
    for piece in (-1, 2**32):
        with pytest.raises(incise.SceneError, match=f"{piece} does not exist"):
            scene.set_blade_piece(blade, piece)


@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_numbers_that_are_not_finite_are_refused_at_the_call(
    sphere: incise.Mesh, value: float
) -> None:
    scene = incise.Scene(contacts=True)
    body = scene.add_body(sphere)
    blade = scene.add_blade(edge(-2))
    scene.pin(body, 3)
    pose, bad = np.array([[0, 0, 0], [0, value, 0]]), np.array([0, value, 0])
    calls: list[tuple[str, Any]] = [
        ("edge", lambda: scene.add_blade(pose)),
        ("edge", lambda: scene.move_blade(blade, pose)),
        ("edge", lambda: scene.teleport_blade(blade, pose)),
        ("face", lambda: scene.set_blade_face(blade, bad)),
        ("target", lambda: scene.set_pin_target(body, 3, bad)),
        ("velocities", lambda: scene.set_velocities(body, np.full_like(sphere.vertices, value))),
        ("origin", lambda: scene.cast_ray(body, bad, [0, 0, 1])),
        ("direction", lambda: scene.cast_ray(body, [0, 0, 1], bad)),
        ("dt", lambda: scene.step(dt=value)),
        ("center", lambda: scene.set_colliders([{"sphere": {"center": bad, "radius": 1}}])),
        ("normal", lambda: sphere.cut(bad)),
        ("d is", lambda: sphere.cut([0, 1, 0], value)),
        ("path", lambda: sphere.cut_path(np.array([pose, pose]))),
        ("damping", lambda: scene.set_material(body, damping=value)),
        ("compliance", lambda: scene.set_material(body, stretch={"compliance": value})),
        ("pressure", lambda: scene.add_body(sphere, volume={"pressure": value})),
    ]
    for name in ("dt", "residual", "grading", "snap", "remesh", "level"):
        option: Any = {name: value}
        calls.append((name, lambda option=option: scene.set_params(**option)))
        calls.append((name, lambda option=option: incise.Scene(**option)))
    calls.append(("diagonal_scale", lambda: scene.set_params(diagonal_scale=value)))
    calls.append(("gravity", lambda: scene.set_params(gravity=bad)))
    calls.append(("thickness", lambda: scene.set_params(contacts={"thickness": value})))
    for name, call in calls:
        with pytest.raises(incise.Error, match=name):
            call()
    assert scene.step().failed_cuts == 0
    assert np.isfinite(scene.positions(body)).all()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"threads": 0}, "threads is 0; it must be a finite number of at least 1"),
        ({"threads": -2}, "threads is -2"),
        ({"substep": -1}, "substep is -1; it must be a finite number above 0"),
        ({"iterations": 2**40}, "iterations is 1099511627776"),
        ({"iterations": 1 << 21}, "iterations is 2097152; it must be from 1 to 1048576"),
    ],
)
def test_numbers_out_of_range_name_the_argument(options: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Scene(**options)
    with pytest.raises(ValueError, match=text):
        incise.Scene().set_params(**options)


def test_unknown_options_of_a_scene_list_those_of_a_scene() -> None:
    misspelled: Any = {"residal": 1}
    scene = incise.Scene()
    for call in (lambda: incise.Scene(**misspelled), lambda: scene.set_params(**misspelled)):
        with pytest.raises(TypeError, match="'residal'; the names are dt.*residual.*level"):
            call()
    with pytest.raises(TypeError, match="iterations is '1.5'; it must be a whole number"):
        incise.Scene(iterations=1.5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="sleep is 'no'; it must be true, false"):
        incise.Scene(sleep="no")  # type: ignore[arg-type]
