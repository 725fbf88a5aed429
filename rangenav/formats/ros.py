"""ROS 2 bags, as a folder with an SQLite file or as one MCAP file: as a robot's recorder writes them.

    /imu/data  sensor_msgs/Imu: rad/s, specific force m/s², no orientation (covariance[0] = −1)      /imu/mag  tesla
    /range     sensor_msgs/Range: m, float32       /ground_truth  geometry_msgs/PoseStamped: z-up, quaternion xyzw
Stamps are nanoseconds and begin at one second, because ROS takes zero for "not set". Written with `rosbags` (pure
Python), which is the extra `ros`.
"""

import struct
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from rangenav.formats.exported_run import ExportedRun, nanoseconds, quaternions, upright_run
from rangenav.formats.output_files import OutputFile, new_folder, write_bytes
from rangenav.inputs import require
from rangenav.preset import Preset

FIRST = 1.0
"""s, the stamp of t = 0."""
FIELD = 50e-6
"""T: an ordinary strength of the earth's field, because a preset holds the direction only."""
VERSION = 9
TRUTH = "/ground_truth"
METADATA, MAX_METADATA = "metadata.yaml", 65_536
MAX_POSES = 2_000_000
MCAP_MAGIC, CHUNK = b"\x89MCAP0\r\n", 6
RECORD = struct.Struct("<BQ")
COMPRESSION, LONGEST_NAME = 28, 20
"""Bytes of a chunk before the name of its compression (two stamps, a size, a checksum), and of that name."""
WORLD, BODY, ANCHOR = "map", "base_link", "anchor"
TOPICS = {
    "/imu/data": "sensor_msgs/msg/Imu",
    "/imu/mag": "sensor_msgs/msg/MagneticField",
    "/range": "sensor_msgs/msg/Range",
    TRUTH: "geometry_msgs/msg/PoseStamped",
}


def write_bag(preset: Preset, path: Path) -> OutputFile:
    """Write a rosbag2 folder (SQLite)."""
    new_folder(path)
    return _written(_write(upright_run(preset), preset, path, mcap=False), (path,))


def write_mcap(preset: Preset, path: Path) -> OutputFile:
    """Write one MCAP file."""
    require(path.parent.is_dir(), f"{path.parent}: no such folder")
    with tempfile.TemporaryDirectory() as folder:
        count = _write(upright_run(preset), preset, Path(folder) / "bag", mcap=True)
        (bag_file,) = (Path(folder) / "bag").glob("*.mcap")
        write_bytes(path, bag_file.read_bytes())
    return _written(count, (path,))


def _written(count: int, files: tuple[Path, ...]) -> OutputFile:
    notes = (
        f"{count} messages; stamps begin at {FIRST:g} s",
        f"the field is given {1e6 * FIELD:g} µT, as presets know its direction only",
    )
    return OutputFile(files=files, frame="z-up", notes=notes, figures={"messages": count})


def _write(run: ExportedRun, preset: Preset, path: Path, *, mcap: bool) -> int:
    ros = _ros()
    plugin = ros.StoragePlugin.MCAP if mcap else ros.StoragePlugin.SQLITE3
    store = ros.get_typestore(ros.Stores.ROS2_HUMBLE)
    stamped = sorted(_messages(run, preset, store.types, first=FIRST), key=lambda entry: entry[0])
    with ros.Writer(path, version=VERSION, storage_plugin=plugin) as writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in TOPICS.items()}
        for stamp, topic, message in stamped:
            writer.write(connections[topic], stamp, store.serialize_cdr(message, TOPICS[topic]))
    return len(stamped)


def refuse_compressed(content: Mapping[str, bytes], source: str) -> None:
    """Raise ValueError for a bag or MCAP file with compressed parts: what they unpack to is not bounded.

    The files that are written here have none. `content` holds the files of a bag by name, or one MCAP file as "".
    """
    rule = f"{source}: has compressed parts, or other files than a bag that rangenav writes"
    if "" in content:
        require(all(not compression for compression in _compressions(content[""])), rule)
        return
    metadata = content.get(METADATA, b"")
    require(len(metadata) <= MAX_METADATA and all(name == METADATA or name.endswith(".db3") for name in content), rule)
    plain = all(metadata.count(b"compression_%s: ''" % key) == 1 for key in (b"format", b"mode"))
    require(plain and metadata.count(b"compression") == 2 and b"\\" not in metadata, rule)


def _compressions(mcap: bytes) -> Iterator[bytes]:
    """The name of the compression of each chunk of an MCAP file, empty for none. A record: opcode, size, content."""
    at = len(MCAP_MAGIC)
    while at + RECORD.size <= len(mcap):
        opcode, size = RECORD.unpack_from(mcap, at)
        at += RECORD.size
        if opcode == CHUNK:
            name = mcap[at + COMPRESSION : at + min(size, COMPRESSION + LONGEST_NAME)]
            yield name[4 : 4 + int.from_bytes(name[:4], "little")]
        at += size


def poses(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Stamps (s) and positions (m) of the true poses in a bag or MCAP file. Raises ValueError without the extra."""
    ros = _ros()
    store, time, places = ros.get_typestore(ros.Stores.ROS2_HUMBLE), [], []
    with ros.Reader(path) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == TRUTH]
        for connection, stamp, data in reader.messages(connections=wanted):
            require(len(time) < MAX_POSES, f"{path.name}: more than {MAX_POSES} poses")
            place = store.deserialize_cdr(data, connection.msgtype).pose.position
            time.append(stamp * 1e-9)
            places.append((place.x, place.y, place.z))
    return np.array(time), np.array(places)


def _messages(run: ExportedRun, preset: Preset, types: Any, *, first: float) -> Iterator[tuple[int, str, Any]]:
    noise, vector = preset.sensors.sigma, types["geometry_msgs/msg/Vector3"]
    point, turn = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Quaternion"]
    stamps, q = nanoseconds(run.time + first), quaternions(run)
    for k, stamp in enumerate(stamps):
        yield (
            stamp,
            "/imu/data",
            types["sensor_msgs/msg/Imu"](
                header=_header(types, stamp, BODY),
                orientation=turn(x=0.0, y=0.0, z=0.0, w=1.0),
                orientation_covariance=_diagonal(-1.0, 0.0),
                angular_velocity=vector(*run.gyro[k].tolist()),
                angular_velocity_covariance=_diagonal(noise.gyro**2, noise.gyro**2),
                linear_acceleration=vector(*run.accel[k].tolist()),
                linear_acceleration_covariance=_diagonal(noise.accel**2, noise.accel**2),
            ),
        )
        if not np.isnan(run.mag[k]).any():
            field = types["sensor_msgs/msg/MagneticField"](
                header=_header(types, stamp, BODY),
                magnetic_field=vector(*(FIELD * run.mag[k]).tolist()),
                magnetic_field_covariance=_diagonal(*[(FIELD * noise.mag) ** 2] * 2),
            )
            yield stamp, "/imu/mag", field
        pose = types["geometry_msgs/msg/Pose"](
            position=point(*run.position[k].tolist()), orientation=turn(*np.roll(q[k], -1).tolist())
        )
        posed = types["geometry_msgs/msg/PoseStamped"](header=_header(types, stamp, WORLD), pose=pose)
        yield stamp, TRUTH, posed
    for stamp, distance in zip(nanoseconds(run.range_time + first), run.range.tolist(), strict=True):
        yield stamp, "/range", _range(types, stamp, distance)


def _range(types: Any, stamp: int, distance: float) -> Any:
    """The message has ultrasound and infrared only. A radio is neither, and its field of view is the whole sphere."""
    kind = types["sensor_msgs/msg/Range"]
    fields = {"radiation_type": 0, "field_of_view": 2 * np.pi, "min_range": 0.0, "max_range": 1e5, "range": distance}
    if "variance" in kind.__dataclass_fields__:
        fields["variance"] = 0.0
    return kind(header=_header(types, stamp, ANCHOR), **fields)


def _header(types: Any, stamp: int, frame: str) -> Any:
    seconds, rest = divmod(stamp, 1_000_000_000)
    time = types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=rest)
    return types["std_msgs/msg/Header"](stamp=time, frame_id=frame)


def _diagonal(first: float, others: float) -> np.ndarray:
    return np.diag([first, others, others]).ravel()


def _ros() -> SimpleNamespace:
    """What is needed of rosbags. Raises ValueError with the extra to install if it is not there."""
    try:
        from rosbags.rosbag2 import Reader, StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise ValueError('bag and mcap need the extra "ros": pip install "rangenav[ros]"') from None
    return SimpleNamespace(
        Reader=Reader, Writer=Writer, StoragePlugin=StoragePlugin, Stores=Stores, get_typestore=get_typestore
    )
