"""Starts tactus-ros2, which must be in PATH, and starts it again if it ends.

    ros2 launch tactus_msgs tactus.launch.py mapping:=skin.json frame_id:=palm
"""

import shlex

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

# Arguments that become flags; what is empty is left out.
FLAGS = {
    "server": "host:port of tactusd",
    "topic": "Topic of the skin; else dataset in the mapping",
    "mapping": "skin.json of the skin",
    "frame_id": "Link that carries the skin",
    "name": "Where contacts are published, as /tactus",
    "bundle": "A model's file, to classify without a server",
}


def start(context):
    command = ["tactus-ros2"]
    for name in FLAGS:
        value = LaunchConfiguration(name).perform(context)
        if value:
            command.append(f"--{name.replace('_', '-')}={value}")
    command += shlex.split(LaunchConfiguration("flags").perform(context))
    return [ExecuteProcess(cmd=command, output="screen", respawn=True,
                           respawn_delay=2.0)]


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value="", description=text)
                 for name, text in FLAGS.items()]
    arguments.append(DeclareLaunchArgument(
        "flags", default_value="", description="Other flags of tactus-ros2"))
    return LaunchDescription(arguments + [OpaqueFunction(function=start)])
