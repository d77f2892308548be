"""Writes the bags of this folder: `pip install rosbags==0.11.9 mcap lz4`, then `python3 make.py` in this folder.

Message k of /joint_states has joint_2 before joint_1, positions k/64 and 1 - k/32, velocities 0.5 and -1, efforts k/16 and -k/8. A gripper
publishes on the same topic, and a reference on another one.
"""

import shutil
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
STATE, TEXT = "sensor_msgs/msg/JointState", "std_msgs/msg/String"
COUNT, START = 60, 1_700_000_000_000_000_000


def state(stamp, names, *values, frame=""):
    types = STORE.types
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id=frame)
    return types[STATE](header, names, *(np.array(list(map(float, each))) for each in values))


def messages(is_stamped, is_little):
    """Topics, types, times of arrival and bytes."""
    for k in range(COUNT):
        time = START + k * 8_000_000
        stamp = time - 1_000_000 if is_stamped else 0
        # The long name does not fit on a page of SQLite.
        arm = state(
            stamp, ["joint_2", "joint_1"], [1 - k / 32, k / 64], [-1, 0.5], [-k / 8, k / 16],
            frame="base" * (2500 if k in (7, 50) else 1),
        )
        gripper = state(stamp + 500_000, ["finger"], [0.01], [], [])
        reference = state(stamp + 500_000, ["joint_1", "joint_2"], [9, 9], [], [])
        text = STORE.types[TEXT](data=f"message {k}")
        for topic, kind, message in [
            ("/joint_states", STATE, arm), ("/joint_states", STATE, gripper), ("/reference", STATE, reference), ("/log", TEXT, text),
        ]:
            yield topic, kind, time, bytes(STORE.serialize_cdr(message, kind, little_endian=is_little))


def bag(name, storage, mode=None, is_stamped=True, is_little=True):
    folder = Path("folder")
    writer = Writer(folder, version=9, storage_plugin=storage)
    if mode:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        topics = {}
        for topic, kind, time, data in messages(is_stamped, is_little):
            if topic not in topics:
                topics[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(topics[topic], time, data)
    (written,) = [path for path in folder.iterdir() if path.name != "metadata.yaml"]
    shutil.move(written, name)
    shutil.rmtree(folder)


def lz4(name):
    with open(name, "wb") as file:
        writer = McapWriter(file, compression=CompressionType.LZ4)
        writer.start(profile="ros2")
        topics = {}
        for topic, kind, time, data in messages(True, True):
            if topic not in topics:
                schema = writer.register_schema(kind, "ros2msg", b"")
                topics[topic] = writer.register_channel(topic, "cdr", schema)
            writer.add_message(topics[topic], time, data, time)
        writer.finish()


bag("sqlite.db3", StoragePlugin.SQLITE3)
bag("unstamped.db3", StoragePlugin.SQLITE3, is_stamped=False)
bag("packed_messages.db3", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
bag("packed.db3.zstd", StoragePlugin.SQLITE3, CompressionMode.FILE)
bag("plain.mcap", StoragePlugin.MCAP, is_little=False)
bag("zstd.mcap", StoragePlugin.MCAP, CompressionMode.STORAGE)
lz4("lz4.mcap")
