# SPDX-License-Identifier: MIT
"""The flight recorder behind connect(record=...)."""

import asyncio
import struct
from pathlib import Path

import pytest

import roburoc4

PACKET = 6


def block_types(path: Path) -> list[int]:
    data, types = path.read_bytes(), []
    while data:
        kind, length = struct.unpack_from("<II", data)
        assert struct.unpack_from("<I", data, length - 4) == (length,)
        types.append(kind)
        data = data[length:]
    return types


@pytest.mark.parametrize("threaded", [True, False])
def test_every_datagram_is_recorded(
    served: roburoc4.Simulator, tmp_path: Path, threaded: bool
) -> None:
    path = tmp_path / "run.pcapng"
    with roburoc4.connect(served.address, record=path, threaded=threaded) as robot:
        robot.wait_for(lambda robot: robot.recorder.recorded > 60, timeout=60)
        assert robot.recorder is not None
        assert robot.recorder.path == str(path)
    state = robot.recorder
    assert state.recorded == block_types(path).count(PACKET) > 40
    assert (state.dropped, state.files, state.system_error) == (0, 1, 0)
    assert state.bytes == path.stat().st_size
    assert served.address.encode() in path.read_bytes()[:200]


def test_aio_records(served: roburoc4.Simulator, tmp_path: Path) -> None:
    path = tmp_path / "run.pcapng"

    async def connect() -> None:
        async with roburoc4.aio.connect(served.address, record=path):
            pass

    asyncio.run(connect())
    assert block_types(path)[-1] == 5


def test_a_long_recording_has_several_files(served: roburoc4.Simulator, tmp_path: Path) -> None:
    path = tmp_path / "run.pcapng"
    with roburoc4.connect(served.address, record=path, record_max_bytes=4000) as robot:
        robot.wait_for(lambda robot: robot.recorder.files > 2)
    assert robot.recorder.files == len(list(tmp_path.iterdir())) > 1
    packets = sum(block_types(file).count(PACKET) for file in tmp_path.iterdir())
    assert packets == robot.recorder.recorded


def test_an_invalid_path_is_named(tmp_path: Path) -> None:
    path = tmp_path / "none" / "run.pcapng"
    with pytest.raises(roburoc4.RecordingError, match=r"record: .*none.*No such file"):
        roburoc4.connect("127.0.0.1", record=path)
    with pytest.raises(roburoc4.ArgumentError, match="record_max_bytes: -1"):
        roburoc4.connect("127.0.0.1", record=path, record_max_bytes=-1)
    with roburoc4.Simulator() as sim, pytest.raises(roburoc4.ArgumentError, match="virtual"):
        sim.connect(record=path)


@pytest.mark.parametrize("name", ["run.csv", "run.pcap", "run"])
def test_only_a_capture_is_called_like_one(name: str, tmp_path: Path) -> None:
    for _ in ("new", "there"):
        with pytest.raises(roburoc4.ArgumentError, match=rf"record: '.*{name}' .* in .pcapng"):
            roburoc4.connect("127.0.0.1:9", wait=False, record=tmp_path / name)
        assert not (tmp_path / name).exists() or not (tmp_path / name).stat().st_size
        (tmp_path / name).touch()
