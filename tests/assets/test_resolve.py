"""Where the files that a robot refers to are found, and where they are not looked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x.assets import resolve
from hymeko_x.assets.resolve import DiskFiles, search_path


def put(path: Path, text: str = "solid") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def package(folder: Path, name: str) -> None:
    put(folder / "package.xml", f"<?xml version='1.0'?>\n<package>\n  <name> {name} </name>\n</package>")


def test_a_relative_path_is_relative_to_the_description(tmp_path: Path) -> None:
    mesh = put(tmp_path / "meshes/arm.stl")
    (tmp_path / "urdf").mkdir()
    files = DiskFiles(tmp_path / "urdf")
    assert files.find("../meshes/arm.stl") == str(mesh)
    assert files.find("..\\meshes\\arm.stl") == str(mesh)
    assert files.find(" ../meshes/arm.stl ") == str(mesh)
    assert files.find("meshes/arm.stl") is None
    assert files.read(str(mesh)) == b"solid"


def test_a_path_through_a_linked_folder_leads_where_the_system_says(tmp_path: Path) -> None:
    mesh = put(tmp_path / "real/meshes/arm.stl")
    (tmp_path / "real/urdf").mkdir()
    (tmp_path / "urdf").symlink_to(tmp_path / "real/urdf")
    found = DiskFiles(tmp_path / "urdf").find("../meshes/arm.stl")
    assert found is not None
    assert mesh.samefile(found)


def test_absolute_paths_and_file_urls_are_followed(tmp_path: Path) -> None:
    mesh = put(tmp_path / "a b.stl")
    files = DiskFiles(tmp_path / "elsewhere")
    quoted = str(mesh).replace(" ", "%20")
    for uri in (str(mesh), f"file://{mesh}", f"file://{quoted}", f"file://localhost{quoted}", f"file:{mesh}", f"FILE://{mesh}"):
        assert files.find(uri) == str(mesh), uri


def test_a_percent_sign_in_a_file_name_is_not_taken_for_an_escape(tmp_path: Path) -> None:
    mesh = put(tmp_path / "50%20.stl")
    assert DiskFiles(tmp_path).find(f"file://{mesh}") == str(mesh)


def test_a_package_is_found_by_the_name_in_the_nearest_package_xml(tmp_path: Path) -> None:
    package(tmp_path / "checkout", "arm_description")
    mesh = put(tmp_path / "checkout/meshes/arm.stl")
    files = DiskFiles(tmp_path / "checkout/urdf")
    assert files.find("package://arm_description/meshes/arm.stl") == str(mesh)
    assert files.find("model://arm_description/meshes/arm.stl") == str(mesh)
    assert files.find("package://leg_description/meshes/arm.stl") is None


def test_a_package_is_found_by_the_name_of_a_folder_above_or_beside(tmp_path: Path) -> None:
    above = put(tmp_path / "arm_description/meshes/arm.stl")
    beside = put(tmp_path / "hand_description/meshes/hand.stl")
    files = DiskFiles(tmp_path / "arm_description/robots/urdf")
    assert files.find("package://arm_description/meshes/arm.stl") == str(above)
    assert files.find("package://hand_description/meshes/hand.stl") == str(beside)


def test_a_package_that_is_not_there_is_the_folder_with_a_form_of_its_name_that_has_the_file(tmp_path: Path) -> None:
    put(tmp_path / "arm/meshes/hand.stl")
    mesh = put(tmp_path / "arm_kr6/meshes/arm.stl")
    files = DiskFiles(tmp_path / "arm_kr6/urdf")
    assert files.find("package://arm_kr6_support/meshes/arm.stl") == str(mesh)
    assert files.find("package://arm_kr6_support/meshes/gone.stl") is None
    assert files.find("package://arm_kr16_support/meshes/arm.stl") is None
    named = put(tmp_path / "arm_kr6_support/meshes/arm.stl")
    assert DiskFiles(tmp_path / "arm_kr6/urdf").find("package://arm_kr6_support/meshes/arm.stl") == str(named)


def test_the_nearest_of_two_packages_with_one_name_wins_and_the_farther_one_fills_gaps(tmp_path: Path) -> None:
    near = put(tmp_path / "p/inner/p/mesh.stl")
    put(tmp_path / "p/mesh.stl")
    only_far = put(tmp_path / "p/other.stl")
    files = DiskFiles(tmp_path / "p/inner/urdf")
    assert files.find("package://p/mesh.stl") == str(near)
    assert files.find("package://p/other.stl") == str(only_far)


def test_the_users_word_comes_before_the_search_path_and_that_before_the_neighbourhood(tmp_path: Path) -> None:
    told, ros, near = (put(tmp_path / f"{place}/p/mesh.stl") for place in ("told", "ros", "near"))
    folders = {"base": tmp_path / "near/p/urdf", "packages": {"p": tmp_path / "told/p"}, "search_path": (tmp_path / "ros",)}
    assert DiskFiles(**folders).find("package://p/mesh.stl") == str(told)
    assert DiskFiles(**{**folders, "packages": {}}).find("package://p/mesh.stl") == str(ros)
    assert DiskFiles(**{**folders, "packages": {}, "search_path": ()}).find("package://p/mesh.stl") == str(near)


def test_a_package_deep_below_the_search_path_is_found_by_its_package_xml(tmp_path: Path) -> None:
    package(tmp_path / "src/repository/arm-checkout", "arm_description")
    mesh = put(tmp_path / "src/repository/arm-checkout/arm.stl")
    files = DiskFiles(tmp_path / "elsewhere", search_path=(tmp_path / "src",))
    assert files.find("package://arm_description/arm.stl") == str(mesh)


def test_ros_and_gazebo_variables_become_the_search_path() -> None:
    environ = {"ROS_PACKAGE_PATH": "/ws/src:/opt/src", "AMENT_PREFIX_PATH": "/opt/ros/jazzy:", "GAZEBO_MODEL_PATH": "/models"}
    assert [path.as_posix() for path in search_path(environ)] == ["/ws/src", "/opt/src", "/opt/ros/jazzy/share", "/models"]
    names = ("SDF_PATH", "GAZEBO_MODEL_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH")
    found = [path.as_posix() for path in search_path({name: f"/{name}" for name in names})]
    assert found == ["/GZ_SIM_RESOURCE_PATH", "/IGN_GAZEBO_RESOURCE_PATH", "/SDF_PATH", "/GAZEBO_MODEL_PATH"]
    assert search_path({}) == ()


@pytest.mark.parametrize(
    "uri", ["", ".", "meshes", "package://", "package://p", "http://h/a.stl", "a\0b", "x" * 5000, "package://../a.stl"]
)
def test_what_names_no_file_is_just_not_there(uri: str, tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    put(tmp_path / "a.stl")
    put(tmp_path / "p")
    assert DiskFiles(tmp_path / "meshes").find(uri) is None


def test_confined_reading_finds_nothing_outside_however_it_is_asked_for(tmp_path: Path) -> None:
    secret = put(tmp_path / "secret/p/key.stl")
    inside = put(tmp_path / "robot/p/mesh.stl")
    (tmp_path / "robot/link.stl").symlink_to(secret)
    files = DiskFiles(tmp_path / "robot", {"p": tmp_path / "secret/p"}, (tmp_path / "secret",), confine=tmp_path / "robot")
    outside = (str(secret), f"file://{secret}", "../secret/p/key.stl", "link.stl", "package://p/key.stl", "package://p/../p/key.stl")
    assert [uri for uri in outside if files.find(uri) is not None] == []
    assert DiskFiles(tmp_path / "robot").find("link.stl") is not None
    assert files.find("package://p/mesh.stl") == str(inside)
    with pytest.raises(FileNotFoundError):
        files.read(str(secret))


def test_a_confined_description_that_is_reached_through_a_link_still_finds_its_files(tmp_path: Path) -> None:
    mesh = put(tmp_path / "real/mesh.stl")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    files = DiskFiles(tmp_path / "link", confine=tmp_path / "link")
    assert files.find("mesh.stl") == str(tmp_path / "link/mesh.stl")
    assert files.find(str(mesh)) == str(mesh)


def test_a_file_above_the_limit_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resolve, "MOST_BYTES", 4)
    with pytest.raises(OSError, match="File too large"):
        DiskFiles(tmp_path).read(str(put(tmp_path / "mesh.stl")))


def test_a_package_without_a_name_is_the_folder_of_the_description_or_one_above(tmp_path: Path) -> None:
    beside, above = put(tmp_path / "robot/part.stl"), put(tmp_path / "meshes/link.stl")
    files = DiskFiles(tmp_path / "robot")
    assert files.find("package:///part.stl") == str(beside)
    assert files.find("package:///meshes/link.stl") == str(above)
    assert files.find("package:///gone.stl") is None
    assert DiskFiles(tmp_path / "robot/urdf", {"": tmp_path}).find("package:///robot/part.stl") == str(beside)
