"""Writing where something else is: devices and pipes, files with permissions of their own, links of others."""

from __future__ import annotations

import contextlib
import os
import select
import stat
import threading

import pytest

from gridgen_sym import atomic
from gridgen_sym.atomic import check_target, read_bytes, write_bytes
from gridgen_sym.errors import GridgenError

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs POSIX files")


def test_a_device_is_written_to_and_stays_one(tmp_path):
    link = tmp_path / "null.vts"
    link.symlink_to("/dev/null")
    write_bytes(link, b"data")
    assert link.is_symlink()
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    if os.path.exists("/dev/full"):
        with pytest.raises(GridgenError, match="cannot write /dev/full: No space left on device"):
            write_bytes("/dev/full", b"data")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root makes devices")
def test_a_device_node_is_not_replaced(tmp_path):
    node = tmp_path / "node.vts"
    try:
        os.mknod(node, 0o600 | stat.S_IFCHR, os.makedev(1, 3))
        write_bytes(node, b"data")
    except (PermissionError, GridgenError):
        pytest.skip("no devices may be made or used here")
    assert stat.S_ISCHR(node.stat().st_mode)


def test_a_pipe_is_written_to_where_a_program_reads_it_and_else_refused(tmp_path):
    pipe = tmp_path / "pipe.vts"
    os.mkfifo(pipe)
    with pytest.raises(GridgenError, match="no program reads that pipe; start its reader first"):
        write_bytes(pipe, b"data")
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    data = b"data" * 100_000  # More than a pipe holds.
    taken = bytearray()

    def read():
        while len(taken) < len(data):
            select.select([reader], [], [], 30)
            with contextlib.suppress(BlockingIOError):
                taken.extend(os.read(reader, 1 << 16))

    thread = threading.Thread(target=read, daemon=True)
    thread.start()
    write_bytes(pipe, data)
    thread.join(timeout=30)
    os.close(reader)
    assert taken == data
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert os.listdir(tmp_path) == ["pipe.vts"]


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o755])
def test_a_file_that_is_replaced_hands_on_its_permissions(tmp_path, mode):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(mode)
    (tmp_path / "link").symlink_to(path)
    write_bytes(path, b"new")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    write_bytes(tmp_path / "link", b"newer")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    write_bytes(path, b"mine", mode=0o600)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
def test_root_leaves_a_file_to_its_owner(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    os.chown(path, 12345, 12346)
    write_bytes(path, b"new")
    assert (path.stat().st_uid, path.stat().st_gid) == (12345, 12346)


def test_a_read_only_file_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(0o444)
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # Nothing is read-only for root.
    with pytest.raises(GridgenError, match=r"cannot write .*: Permission denied; check the permissions"):
        write_bytes(path, b"new")
    assert path.read_bytes() == b"old"


def test_a_folder_closed_to_us_is_noticed_before_anything_is_written(tmp_path, monkeypatch):
    check_target(tmp_path / "new")
    monkeypatch.setattr(os, "access", lambda path, mode: path != tmp_path)
    with pytest.raises(
        GridgenError, match="Permission denied; check the permissions of its folder, or write elsewhere"
    ):
        check_target(tmp_path / "new")
    (tmp_path / "old").write_bytes(b"old")
    with pytest.raises(GridgenError, match="check the permissions of its folder"):
        check_target(tmp_path / "old")
    check_target("/dev/null")
    assert os.listdir(tmp_path) == ["old"]


def test_a_link_that_another_user_laid_in_a_folder_for_everyone_is_not_followed(tmp_path, monkeypatch):
    (tmp_path / "mine").write_bytes(b"old")
    folder = tmp_path / "everyone"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path / "mine")
    folder.chmod(0o1777)
    write_bytes(folder / "link", b"new")  # One's own link may be followed.
    owner = folder.stat().st_uid
    monkeypatch.setattr(atomic.os, "geteuid", lambda: owner + 1)
    write_bytes(folder / "link", b"new")  # That of the folder's owner, too.
    if owner != 0:
        return
    os.lchown(folder / "link", 12345, 12345)
    with pytest.raises(GridgenError, match="another user's symbolic link in a folder for everyone; name the file"):
        write_bytes(folder / "link", b"newer")
    folder.chmod(0o755)
    write_bytes(folder / "link", b"newest")
    assert (tmp_path / "mine").read_bytes() == b"newest"


def test_a_link_to_nothing_makes_the_file_and_a_loop_is_an_error(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "new")
    write_bytes(tmp_path / "link", b"data")
    assert (tmp_path / "new").read_bytes() == b"data"
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(GridgenError, match=r"cannot write .*loop"):
        write_bytes(tmp_path / "loop", b"data")


def test_a_device_is_not_read():
    """/dev/zero has no end."""
    with pytest.raises(GridgenError, match="cannot read /dev/zero: it is a device; name a file"):
        read_bytes("/dev/zero")
