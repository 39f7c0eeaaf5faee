"""Bodies without inertia get that of their shapes: exact for primitives and closed meshes, of the convex hull for open ones."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.cli import exits, main
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Body, Inertial

LINKS = """<robot name="r">
  <link name="a">{shapes}</link>
  <link name="b"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="b"/><child link="a"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
BOX = '<collision><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
MESH = '<{role}><origin xyz="0.5 0 0"/><geometry><mesh filename="{file}" scale="2 1 1"/></geometry></{role}>'


def converted(folder: Path, shapes: str, **options: object) -> tuple[Inertial | None, list[str]]:
    (folder / "r.urdf").write_text(LINKS.format(shapes=shapes))
    done = hx.convert(folder / "r.urdf", folder / "out.urdf", **options)  # type: ignore[arg-type]
    assert done.losses == ()
    written: Mechanism = hx.load(folder / "out.urdf").mechanism
    assert written.vertex(Id("body", "b"), Body) == hx.load(folder / "r.urdf").mechanism.vertex(Id("body", "b"), Body)
    return written.vertex(Id("body", "a"), Body).inertial, [d.message for d in done.report if d.code.id in ("HX114", "HX103")]


def test_a_box_counts_exactly_where_it_is(tmp_path: Path) -> None:
    inertial, reported = converted(tmp_path, BOX, density=500.0)
    assert inertial is not None
    assert (inertial.mass, inertial.com) == (pytest.approx(3.0), (0.0, 0.0, 1.0))
    expected = (0.25 * (0.1**2 + 0.3**2), 0.25 * (0.2**2 + 0.3**2), 0.25 * (0.1**2 + 0.2**2), 0.0, 0.0, 0.0)
    assert inertial.tensor == pytest.approx(expected, abs=1e-12)
    assert reported == ["--density 500: 1 body with masses and inertias of their collision shapes, 3 kg together"]


def test_a_closed_mesh_counts_as_the_box_that_it_is(tmp_path: Path) -> None:
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "box.stl")
    inertial, reported = converted(tmp_path, MESH.format(role="collision", file="box.stl"), density=500.0)
    assert inertial is not None
    assert inertial.mass == pytest.approx(6.0, rel=1e-6)
    assert inertial.com == pytest.approx((0.5, 0.0, 0.0), abs=1e-6)
    assert inertial.tensor == pytest.approx((0.065, 0.065, 0.04, 0.0, 0.0, 0.0), rel=1e-6, abs=1e-9)
    assert len(reported) == 1


def test_an_open_mesh_counts_as_its_hull_and_that_is_reported(tmp_path: Path) -> None:
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    trimesh.Trimesh(box.vertices, box.faces[1:]).export(tmp_path / "open.stl")
    inertial, reported = converted(tmp_path, MESH.format(role="visual", file="open.stl"), inertia_from="visual")
    assert inertial is not None
    assert inertial.mass == pytest.approx(12.0, rel=1e-6)
    assert reported == [
        "--density 1000: 1 body with masses and inertias of their visual shapes, 12 kg together",
        "--density 1000: 1 mesh not closed, taken as convex hulls: 'open'",
    ]


def test_hulls_are_taken_where_they_are_asked_for(tmp_path: Path) -> None:
    cross = trimesh.boolean.union([trimesh.creation.box((1, 0.1, 0.1)), trimesh.creation.box((0.1, 1, 0.1))], engine="manifold")
    cross.export(tmp_path / "cross.stl")
    shapes = MESH.format(role="collision", file="cross.stl")
    exact, _ = converted(tmp_path, shapes, inertia_from="collision")
    hull, _ = converted(tmp_path, shapes, inertia_from="hull")
    assert exact is not None
    assert hull is not None
    assert (exact.mass, hull.mass) == (pytest.approx(38.0, rel=1e-5), pytest.approx(2000 * cross.convex_hull.volume, rel=1e-5))


def test_a_missing_mesh_has_no_mass_and_is_named(tmp_path: Path) -> None:
    inertial, reported = converted(tmp_path, MESH.format(role="collision", file="nowhere.stl"), density=1000.0)
    assert inertial is None
    assert reported[1] == "--density 1000: 1 mesh flat, missing or unreadable: 'nowhere'"


def test_without_the_options_nothing_is_made_up_and_the_warning_names_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(LINKS.format(shapes=BOX))
    assert main(["convert", str(tmp_path / "r.urdf"), str(tmp_path / "r.xml"), "--base", "fixed"]) == exits.DONE
    assert "hint: --density 1000 computes masses from shapes" in capsys.readouterr().err
    assert main(["convert", str(tmp_path / "r.urdf"), str(tmp_path / "r.xml"), "--base", "fixed", "--density", "1000"]) == exits.DONE
    assert "HX103" not in capsys.readouterr().err


def test_a_density_is_a_positive_number(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "a.urdf", "b.xml", "--density", "-1"]) == exits.USAGE
    assert "expected a positive number of kg/m^3, found '-1'" in capsys.readouterr().err
