"""$(find package) without ROS."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x import codes
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.xacro import read
from hymeko_x.source import Source
from tests.xacro.samples import Folder, robot

PART = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="{}"/></robot>'
INCLUDE = '<xacro:include filename="$(find arm)/urdf/arm.xacro"/>'


def package(folder: Folder, place: str, name: str | None, link: str) -> Path:
    """A package with one macro file; without a name it has no package.xml."""
    if name:
        folder.put(f"{place}/package.xml", f"<package><name>{name}</name></package>")
    return folder.put(f"{place}/urdf/arm.xacro", PART.format(link)).parents[1]


def found(folder: Folder, name: str = "robots/r.xacro", body: str = INCLUDE, **how: object) -> list[str]:
    """The links of the robot in a file."""
    folder.put(name, f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{body}\n</robot>')
    mechanism = read(folder.source(name, **how), Report()).mechanism
    return [key.name for key in mechanism.graph.vertices if key.kind == "body"]


def test_the_package_around_the_file_is_found_by_its_package_xml(folder: Folder) -> None:
    package(folder, "checkout", "arm", "around")
    assert found(folder, "checkout/deep/r.xacro") == ["around"]


def test_a_package_beside_the_own_one_is_found_by_its_package_xml(folder: Folder) -> None:
    package(folder, "src/arm-ros2", "arm", "beside")
    assert found(folder, "src/robot/urdf/r.xacro") == ["beside"]


def test_a_package_is_found_by_the_name_of_its_folder(folder: Folder) -> None:
    package(folder, "src/arm", None, "beside")
    assert found(folder, "src/robot/urdf/r.xacro") == ["beside"]


def test_the_order_is_the_users_word_near_package_xml_search_path_and_name_of_a_folder(folder: Folder) -> None:
    told = package(folder, "told", None, "told")
    package(folder, "src/arm-2", "arm", "near")
    package(folder, "ros/arm", None, "ros")
    package(folder, "src/arm", None, "folder")
    ros = folder.path / "ros"
    assert found(folder, "src/robot/r.xacro", packages={"arm": told}, search_path=(ros,)) == ["told"]
    assert found(folder, "src/robot/r.xacro", search_path=(ros,)) == ["near"]
    (folder.path / "src/arm-2/package.xml").unlink()
    assert found(folder, "src/robot/r.xacro", search_path=(ros,)) == ["ros"]
    assert found(folder, "src/robot/r.xacro") == ["folder"]


def test_the_nearest_of_several_packages_with_one_name_is_taken(folder: Folder) -> None:
    package(folder, "far", "arm", "far")
    package(folder, "src/near", "arm", "near")
    assert found(folder, "src/robot/r.xacro") == ["near"]
    assert found(folder, "r.xacro") == ["far"]


def test_an_included_package_finds_its_own_neighbours(folder: Folder) -> None:
    package(folder, "elsewhere/arm", "arm", "neighbour")
    hand = folder.put("elsewhere/hand/hand.xacro", f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{INCLUDE}</robot>').parent
    body = '<xacro:include filename="$(find hand)/hand.xacro"/>'
    assert found(folder, "src/robot/r.xacro", body, packages={"hand": hand}) == ["neighbour"]


def test_a_folder_with_a_shorter_form_of_the_name_is_taken_with_a_warning(folder: Folder) -> None:
    package(folder, "src/arm_kr6", None, "guess")
    folder.put("src/arm_kr6/urdf/r.xacro", "")
    text = '<xacro:include filename="$(find arm_kr6_support)/urdf/arm.xacro"/>'
    report = Report()
    data = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{text}\n</robot>'.encode()
    place = folder.path / "src/arm_kr6/urdf/r.xacro"
    read(Source(str(place), data, DiskFiles(place.parent)), report)
    assert [str(diagnostic) for diagnostic in report] == [
        f"{place}:2: warning[HX052]: there is no package 'arm_kr6_support'; the folder '{folder.path}/src/arm_kr6' is taken for it\n"
        "  hint: say where it is: --package arm_kr6_support=DIR"
    ]


def test_a_guess_that_lacks_the_file_is_a_missing_package(folder: Folder) -> None:
    (folder.path / "arm").mkdir()
    refusal = folder.refusal('<xacro:include filename="$(find arm_description)/urdf/arm.xacro"/>')
    assert (refusal.code, refusal.message) == (codes.PACKAGE_NOT_FOUND, "the package 'arm_description' was not found")


def test_a_missing_package_is_named_with_its_place_and_what_to_pass(folder: Folder) -> None:
    refusal = folder.refusal("\n" + INCLUDE)
    assert (refusal.code, refusal.message) == (codes.PACKAGE_NOT_FOUND, "the package 'arm' was not found")
    assert str(refusal.origin) == f"{folder.path}/r.xacro:3"
    assert refusal.hint == (
        "say where it is: --package arm=DIR (looked for: a package.xml with that name and a folder 'arm' above or beside the file, "
        "ROS_PACKAGE_PATH, AMENT_PREFIX_PATH)"
    )


def test_find_works_inside_eval(folder: Folder) -> None:
    package(folder, "arm", None, "eval")
    body = '<xacro:property name="p" value="find(\'arm\')"/>\n<xacro:include filename="$(eval ${p})/urdf/arm.xacro"/>'
    assert found(folder, body=body) == ["eval"]


@pytest.mark.parametrize("name", ["..", ".", "../secret", "a/b", "/etc"])
def test_a_package_name_is_no_path(folder: Folder, name: str) -> None:
    folder.put("secret/urdf/arm.xacro", PART.format("secret"))
    (folder.path / "robots").mkdir()
    assert DiskFiles(folder.path / "robots").find_package(name) is None


def test_confined_reading_leaves_the_folder_by_no_way(folder: Folder) -> None:
    inside = folder.path / "inside"
    package(folder, "arm", "arm", "outside")
    package(folder, "inside/arm", None, "inside")
    how = {"confine": inside, "packages": {"arm": folder.path / "arm"}, "search_path": (folder.path,)}
    assert found(folder, "inside/robots/r.xacro", **how) == ["inside"]
    (inside / "link").symlink_to(folder.path / "arm")
    outside = ("../../arm/urdf/arm.xacro", f"{folder.path}/arm/urdf/arm.xacro", "../link/urdf/arm.xacro", "../../ar*/urdf/arm.xacro")
    for text in (*outside, "/etc/passwd"):
        folder.put("inside/robots/r.xacro", robot(f'<xacro:include filename="{text}"/><link name="a"/>'))
        report = Report()
        refused = read_or_refusal(folder.source("inside/robots/r.xacro", confine=inside), report)
        assert refused in (codes.INCLUDE_NOT_FOUND, None)
        assert (refused is None) == ("*" in text)
        assert all(diagnostic.code == codes.LIBRARY_MESSAGE for diagnostic in report)


def read_or_refusal(source: Source, report: Report) -> object:
    try:
        mechanism = read(source, report).mechanism
    except Refusal as refusal:
        return refusal.diagnostic.code
    assert [key.name for key in mechanism.graph.vertices if key.kind == "body"] == ["a"]
    return None


def test_a_pattern_that_would_look_everywhere_names_nothing(folder: Folder) -> None:
    folder.put("a/b/c.xacro", "")
    files = DiskFiles(folder.path)
    assert files.match("*/?/[a-c]*.xacro") == [str(folder.path / "a/b/c.xacro")]
    assert files.match("*/../*/../*/../*/../a/b/*.xacro") == []
    assert [files.match(pattern) for pattern in ("", "*\0", "no/*", "a", "x" * 5000 + "*")] == [[], [], [], [], []]
