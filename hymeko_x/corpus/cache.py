"""The user's cache of unpacked corpus packages: where it is, and how a package gets there.

A package is downloaded by pip, so that the user's index, proxy and certificates hold, then checked against the
catalogue's checksum and unpacked into a sibling that is renamed when it is complete. A folder that exists is complete.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from hymeko_x import codes
from hymeko_x.assets import archives
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.corpus.catalog import WheelPackage

CACHE_VARIABLE = "HYMEKO_X_CACHE"
OFFLINE_WORDS = ("NewConnectionError", "ConnectionError", "ConnectTimeout", "Max retries exceeded", "name resolution", "Connection refused")
POLL_SECONDS = 0.1
LOCK_SECONDS = 3600.0


class DownloadProgress(Protocol):
    """A callback that shows the progress of a download."""

    def __call__(self, package: WheelPackage, received: int) -> None:
        """Called about ten times a second with the bytes that have arrived so far."""
        ...


def _unwatched(package: WheelPackage, received: int) -> None:
    """Shows nothing."""


def cache_root(environ: Mapping[str, str]) -> Path:
    """The cache folder: $HYMEKO_X_CACHE if set, else `hymeko-x` in the platform's cache folder of this user."""
    chosen = environ.get(CACHE_VARIABLE)
    if chosen:
        return Path(chosen).expanduser().absolute()
    from platformdirs import user_cache_path

    return user_cache_path("hymeko-x", appauthor=False)


def package_path(package: WheelPackage, root: Path) -> Path:
    """Where the unpacked package is, or will be."""
    return root / "corpus" / package.folder


def is_fetched(package: WheelPackage, root: Path) -> bool:
    """Whether the package is there, complete."""
    return package_path(package, root).is_dir()


def fetch(package: WheelPackage, root: Path, *, watch: DownloadProgress = _unwatched) -> Path:
    """Download and unpack a package unless it is there; return its folder. Safe when several processes do it at once.

    Raises: Refusal HX210 or HX213 when pip cannot download it, HX212 when the wheel is not the catalogue's, HX002 when the cache
    cannot be written.
    """
    final = package_path(package, root)
    if final.is_dir():
        return final
    try:
        return _fetch_alone(package, final, watch)
    except OSError as error:
        raise refuse(codes.CANNOT_WRITE, f"the cache '{root}' cannot be written: {error}", hint=f"set {CACHE_VARIABLE}") from error


def _fetch_alone(package: WheelPackage, final: Path, watch: DownloadProgress) -> Path:
    """Do it under a lock; a process that waited finds the work done. What a killed run left behind is removed first."""
    from filelock import FileLock

    final.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(f"{final}.lock", timeout=LOCK_SECONDS):
        if final.is_dir():
            return final
        part = final.with_name(final.name + ".part")
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir()
        try:
            _fill(package, part, watch).rename(final)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return final


def _fill(package: WheelPackage, part: Path, watch: DownloadProgress) -> Path:
    """Download, check and unpack inside ``part``; return the folder with the content."""
    wheel = download(package, part / "wheel", watch)
    check(package, wheel)
    content = part / "content"
    try:
        archives.unpack(wheel, content, package.wants)
    except archives.DAMAGED as error:
        raise refuse(codes.PACKAGE_DAMAGED, f"{wheel.name} cannot be unpacked: {error}") from error
    return content


def download(package: WheelPackage, folder: Path, watch: DownloadProgress = _unwatched) -> Path:
    """Let pip put the package's wheel into ``folder``; return its path.

    Raises: Refusal HX213 when the index cannot be reached, else HX210 with pip's own last words.
    """
    temporary = folder / "tmp"
    temporary.mkdir(parents=True)
    places = dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(temporary))
    with (folder / "pip.log").open("wb") as log:
        pip = subprocess.Popen(pip_command(package, folder), stdout=log, stderr=log, env={**os.environ, **places})
        try:
            while pip.poll() is None:
                watch(package, _size(folder))
                time.sleep(POLL_SECONDS)
        finally:
            pip.kill()
            pip.wait()
    wheels = sorted(folder.glob("*.whl"))
    if pip.returncode != 0 or not wheels:
        raise _download_refusal(package, (folder / "pip.log").read_text("utf-8", "replace"))
    watch(package, package.bytes)
    return wheels[0]


def pip_command(package: WheelPackage, folder: Path) -> list[str]:
    """The arguments that make pip download exactly this wheel.

    The data in a wheel does not depend on the machine, so a wheel for one platform is asked for by its own tags
    and serves everywhere.
    """
    python, abi, platforms = package.wheel.removesuffix(".whl").rsplit("-", 3)[1:]
    command = [sys.executable, "-W", "ignore", "-m", "pip", "download", "--no-deps", "--only-binary", ":all:", "--ignore-requires-python"]
    command += ["--no-input", "--disable-pip-version-check", "--progress-bar", "off", "--dest", str(folder)]
    if platforms != "any":
        command += ["--python-version", python.removeprefix("cp"), "--implementation", "cp", "--abi", abi]
        command += [word for platform in platforms.split(".") for word in ("--platform", platform)]
    return [*command, f"{package.name}=={package.version}"]


def is_offline(log: str) -> bool:
    """Whether pip's words say that the package index could not be reached at all."""
    return any(word in log for word in OFFLINE_WORDS)


def check(package: WheelPackage, wheel: Path) -> None:
    """Compare the wheel's bytes with the catalogue.

    Raises: Refusal HX212 when they differ.
    """
    with wheel.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    if found != package.sha256:
        raise refuse(
            codes.PACKAGE_DAMAGED,
            f"{wheel.name} has the sha256 {found[:16]}..., the catalogue wants {package.sha256[:16]}... of {package.wheel}",
            hint="the download broke, or the package index serves another file under this name",
        )


def _download_refusal(package: WheelPackage, log: str) -> Exception:
    wanted = f"{package.name}=={package.version}"
    if is_offline(log):
        message = f"{wanted} cannot be downloaded: the package index cannot be reached"
        return refuse(codes.OFFLINE, message, hint="are you online? what was fetched before stays usable")
    errors = [line.removeprefix("ERROR: ") for line in log.splitlines() if line.startswith("ERROR: ")]
    words = errors[-1] if errors else (log.strip().splitlines() or ["pip printed nothing"])[-1]
    return refuse(codes.PACKAGE_UNAVAILABLE, f"{wanted} cannot be downloaded: {words}", hint=f"the index must have {package.wheel}")


def _size(folder: Path) -> int:
    """The bytes under a folder, as far as they can be seen while another process writes there."""
    total = 0
    for place, _, names in os.walk(folder):  # unlike rglob it passes over folders that vanish
        for name in names:
            with suppress(FileNotFoundError):
                total += os.stat(os.path.join(place, name)).st_size
    return total
