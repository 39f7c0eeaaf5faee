"""The corpus: its catalogue, and a cache that is never half-filled."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import pytest

from hymeko_x import codes
from hymeko_x.assets import archives
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal

if TYPE_CHECKING:
    from collections.abc import Mapping


def make_wheel(folder: Path, members: Mapping[str, bytes], name: str = "toy_robots") -> catalog.WheelPackage:
    """A wheel of our own in ``folder`` and its catalogue entry."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}-1.0.0-py3-none-any.whl"
    info = f"{name}-1.0.0.dist-info"
    words = {f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0.0\n", f"{info}/WHEEL": "Wheel-Version: 1.0\n"}
    with zipfile.ZipFile(path, "w") as zipped:
        for member, data in {**members, **words, f"{info}/RECORD": ""}.items():
            zipped.writestr(member, data)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return catalog.WheelPackage(name, "1.0.0", "one toy", "Apache-2.0", path.name, path.stat().st_size, digest, (), {})


ROBOT = {"toy_robots/toy.urdf": b"<robot name='toy'/>", "toy_robots/__init__.py": b"raise SystemExit", "toy_robots/LICENSE": b"ours"}


@pytest.fixture
def index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that pip takes wheels from, and nothing else."""
    folder = tmp_path / "index"
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    return folder


# ---- the catalogue -------------------------------------------------------------------------------------------------------


def test_the_catalogue_names_wheels_by_name_version_and_checksum() -> None:
    for package in catalog.load():
        assert package.wheel.startswith(f"{package.name}-{package.version}-")
        assert len(bytes.fromhex(package.sha256)) == 32
        assert package.bytes > 100_000
        assert package.licence
        assert package.carries


def test_every_development_file_is_something_that_the_cache_keeps() -> None:
    assert [f for package in catalog.load() for paths in package.files.values() for f in paths if not package.wants(f)] == []


def test_the_development_files_are_as_many_of_each_format_as_the_bounds_count_on() -> None:
    counts = {format: len(catalog.development_files(format)) for format in ("urdf", "mjcf", "xacro", "usd", "sdf")}
    assert counts == {"urdf": 60, "mjcf": 80, "xacro": 30, "usd": 30, "sdf": 16}


def test_packages_are_selected_in_catalogue_order_whatever_the_spelling() -> None:
    assert [package.name for package in catalog.select(("Upkie-Description", "newton"))] == ["newton", "upkie_description"]
    assert catalog.select(()) == catalog.load()


def test_a_package_that_is_not_in_the_catalogue_is_refused_with_a_list_of_those_that_are() -> None:
    with pytest.raises(Refusal) as refusal:
        catalog.select(("newton", "no-such-robot"))
    assert refusal.value.diagnostic.code == codes.PACKAGE_UNKNOWN
    assert refusal.value.diagnostic.message == "the catalogue has no package 'no_such_robot'"
    assert "example_robot_data, pybullet" in refusal.value.diagnostic.hint


def test_data_is_kept_and_code_is_dropped() -> None:
    package = catalog.select(("newton",))[0]
    kept = [
        "a/robot.urdf",
        "a/MESH.STL",
        "a/b.dae",
        "x.dist-info/licenses/LICENSE",
        "x.dist-info/METADATA",
        "a/COPYING.LIB",
        "p/package.xml",
    ]
    dropped = ["a/b.py", "a/c.so", "a/d.pyc", "a/RECORD", "a/e.ipynb", "a/f.npz"]
    assert [name for name in kept + dropped if package.wants(name)] == kept


def test_a_large_package_is_narrowed_to_the_folders_with_robots() -> None:
    drake = catalog.select(("drake",))[0]
    assert drake.wants("pydrake/share/drake/examples/acrobot/Acrobot.sdf")
    assert not drake.wants("pydrake/share/drake/tutorials/package.xml")


def test_another_wheel_gets_another_folder() -> None:
    package = catalog.load()[0]
    assert package.folder.startswith("example_robot_data-6.0.0-")
    assert msgspec.structs.replace(package, sha256="0" * 64).folder != package.folder
    assert msgspec.structs.replace(package, only=("a/",)).folder != package.folder


# ---- fetching ------------------------------------------------------------------------------------------------------------


def test_a_fetched_package_holds_its_data_and_nothing_else(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, ROBOT)
    seen: list[int] = []
    folder = cache.fetch(package, tmp_path / "cache", watch=lambda _, received: seen.append(received))
    assert folder == cache.package_path(package, tmp_path / "cache")
    assert (folder / "toy_robots/toy.urdf").read_bytes() == ROBOT["toy_robots/toy.urdf"]
    assert sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()) == [
        "toy_robots-1.0.0.dist-info/METADATA",
        "toy_robots/LICENSE",
        "toy_robots/toy.urdf",
    ]
    assert seen[-1] == package.bytes


def test_a_package_that_is_there_is_not_downloaded_again(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, ROBOT)
    first = cache.fetch(package, tmp_path / "cache")
    for wheel in index.iterdir():
        wheel.unlink()
    assert cache.fetch(package, tmp_path / "cache") == first


def test_a_wrong_checksum_leaves_nothing_in_the_cache(index: Path, tmp_path: Path) -> None:
    package = msgspec.structs.replace(make_wheel(index, ROBOT), sha256="ab" * 32)
    with pytest.raises(Refusal, match="the catalogue wants abababababababab...") as refusal:
        cache.fetch(package, tmp_path / "cache")
    assert refusal.value.diagnostic.code == codes.PACKAGE_DAMAGED
    assert not cache.is_fetched(package, tmp_path / "cache")
    assert [p.name for p in (tmp_path / "cache/corpus").iterdir()] in ([], [f"{package.folder}.lock"])


def test_what_a_killed_run_left_behind_does_not_disturb_the_next_one(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, ROBOT)
    part = cache.package_path(package, tmp_path).with_name(package.folder + ".part")
    (part / "content").mkdir(parents=True)
    (part / "content" / "half.urdf").write_text("<rob")
    folder = cache.fetch(package, tmp_path)
    assert not part.exists()
    assert not (folder / "half.urdf").exists()


def test_a_package_that_the_index_does_not_have_is_refused_in_pips_words(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, ROBOT)
    with pytest.raises(Refusal) as refusal:
        cache.fetch(msgspec.structs.replace(package, version="9.9.9"), tmp_path / "cache")
    assert refusal.value.diagnostic.code == codes.PACKAGE_UNAVAILABLE
    assert (
        refusal.value.diagnostic.message == "toy_robots==9.9.9 cannot be downloaded: No matching distribution found for toy_robots==9.9.9"
    )


def test_being_offline_is_reported_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "1")
    with pytest.raises(Refusal) as refusal:
        cache.fetch(catalog.select(("newton",))[0], tmp_path)
    assert refusal.value.diagnostic.code == codes.OFFLINE
    assert refusal.value.diagnostic.message == "newton==1.8.0 cannot be downloaded: the package index cannot be reached"


def test_a_cache_that_cannot_be_written_is_reported_in_one_line(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, ROBOT)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(Refusal) as refusal:
        cache.fetch(package, tmp_path / "file")
    assert refusal.value.diagnostic.code == codes.CANNOT_WRITE
    assert refusal.value.diagnostic.hint == "set HYMEKO_X_CACHE"


def test_two_processes_that_fetch_the_same_package_do_not_disturb_each_other(index: Path, tmp_path: Path) -> None:
    package = make_wheel(index, {f"toy_robots/{i}.urdf": b"<robot/>" * 1000 for i in range(500)})
    program = (
        "import sys; from pathlib import Path; from hymeko_x.corpus import cache, catalog\n"
        f"package = catalog.{package!r}\nprint(cache.fetch(package, Path(sys.argv[1])))"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "cache")]
    runs = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    printed = [run.communicate(timeout=60) for run in runs]
    assert [run.returncode for run in runs] == [0, 0], printed
    folder = cache.package_path(package, tmp_path / "cache")
    assert [out.strip() for out, _ in printed] == [str(folder)] * 2
    assert len(list((folder / "toy_robots").iterdir())) == 500


def test_a_wheel_for_one_platform_is_asked_for_by_its_own_tags() -> None:
    package = catalog.select(("pybullet",))[0]
    command = cache.pip_command(package, Path("here"))
    assert command[command.index("--python-version") :] == [
        *("--python-version", "311", "--implementation", "cp", "--abi", "cp311"),
        *("--platform", "manylinux_2_17_x86_64", "--platform", "manylinux2014_x86_64"),
        "pybullet==3.2.7",
    ]


def test_a_wheel_for_every_platform_is_asked_for_plainly() -> None:
    command = cache.pip_command(catalog.select(("newton",))[0], Path("here"))
    assert command[-3:] == ["--dest", "here", "newton==1.8.0"]
    assert "--platform" not in command


def test_the_cache_is_where_the_user_wants_it(tmp_path: Path) -> None:
    assert cache.cache_root({"HYMEKO_X_CACHE": str(tmp_path)}) == tmp_path
    assert cache.cache_root({}).name == "hymeko-x"


# ---- unpacking -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["../out.urdf", "/etc/out.urdf", "a/../../out.urdf", "C:/out.urdf", "a\\..\\out.urdf"])
def test_an_archive_that_would_write_elsewhere_is_refused_whole(name: str, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "evil.whl", "w") as zipped:
        zipped.writestr("good.urdf", "<robot/>")
        zipped.writestr(name, "<robot/>")
    with pytest.raises(Refusal, match="which would leave the folder") as refusal:
        archives.unpack(tmp_path / "evil.whl", tmp_path / "to", lambda _: True)
    assert refusal.value.diagnostic.code == codes.PACKAGE_DAMAGED
    assert not (tmp_path / "to").exists()


def test_a_link_in_an_archive_is_refused(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("link.urdf")
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(tmp_path / "evil.whl", "w") as zipped:
        zipped.writestr(link, "/etc/passwd")
    with pytest.raises(Refusal, match="which would leave the folder"):
        archives.unpack(tmp_path / "evil.whl", tmp_path / "to", lambda _: True)


def test_an_archive_that_grows_without_bound_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archives, "MOST_UNPACKED", 2**20)
    with zipfile.ZipFile(tmp_path / "bomb.whl", "w", zipfile.ZIP_DEFLATED) as zipped:
        zipped.writestr("zeros.stl", bytes(2**20 + 1))
    with pytest.raises(Refusal, match="unpacks to 1 files, 1048577 bytes; allowed") as refusal:
        archives.unpack(tmp_path / "bomb.whl", tmp_path / "to", lambda _: True)
    assert refusal.value.diagnostic.code == codes.TOO_LARGE


# ---- the real thing ------------------------------------------------------------------------------------------------------


@pytest.mark.corpus
def test_a_published_package_arrives_with_its_development_files(corpus_root: Path) -> None:
    package = catalog.select(("upkie_description",))[0]
    folder = cache.fetch(package, corpus_root)
    assert [path for paths in package.files.values() for path in paths if not (folder / path).is_file()] == []
    assert not list(folder.rglob("*.py"))
