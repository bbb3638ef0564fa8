# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The description of a rosbag2 folder (``metadata.yaml``, version 9) and its QoS profiles."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from msss_graphslam.messages import topics

__all__ = ["TopicSummary", "bag_metadata", "parse_qos", "qos_profile"]

# One profile serves all: deeper than a full turn of beams, so that none is lost on the way.
_DEPTH = 1000
_FOREVER = {"sec": 9223372036, "nsec": 854775807}


@dataclass(slots=True)
class TopicSummary:
    """What metadata.yaml tells of one topic."""

    name: str
    type_name: str
    type_hash: str
    qos: list[dict[str, Any]]
    encoding: str = "cdr"
    count: int = 0


def qos_profile(topic: str) -> dict[str, Any]:
    """Return the QoS that the topic is offered with, in rosbag2's words."""
    known = topics.find(topic)
    latched = known is not None and known.latched
    return {
        "history": "keep_last",
        "depth": 1 if latched else _DEPTH,
        "reliability": "reliable",
        "durability": "transient_local" if latched else "volatile",
        "deadline": dict(_FOREVER),
        "lifespan": dict(_FOREVER),
        "liveliness": "automatic",
        "liveliness_lease_duration": dict(_FOREVER),
        "avoid_ros_namespace_conventions": False,
    }


def parse_qos(text: str) -> list[dict[str, Any]]:
    """Return the profiles that a channel's metadata holds as YAML; none where it is not such."""
    try:
        profiles = yaml.safe_load(text)
    except yaml.YAMLError:
        return []
    return profiles if isinstance(profiles, list) else []


def bag_metadata(file_name: str, summaries: Sequence[TopicSummary], span_ns: range) -> str:
    """Return the text of metadata.yaml for a bag of one file; ``span_ns`` are its log times."""
    count = sum(summary.count for summary in summaries)
    times = {
        "starting_time": {"nanoseconds_since_epoch": span_ns.start},
        "duration": {"nanoseconds": span_ns.stop - span_ns.start},
        "message_count": count,
    }
    information = {
        "version": 9,
        "storage_identifier": "mcap",
        **times,
        "topics_with_message_count": [_topic(summary) for summary in summaries],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file_name],
        "files": [{"path": file_name, **times}],
        "custom_data": None,
        "ros_distro": "jazzy",
    }
    return _dump({"rosbag2_bagfile_information": information})


def _topic(summary: TopicSummary) -> dict[str, Any]:
    described = {
        "name": summary.name,
        "type": summary.type_name,
        "serialization_format": summary.encoding,
        "offered_qos_profiles": summary.qos,
        "type_description_hash": summary.type_hash,
    }
    return {"topic_metadata": described, "message_count": summary.count}


class _Dumper(yaml.SafeDumper):
    """YAML without anchors, which rosbag2's parser need not resolve."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
        return True


def _dump(value: Any) -> str:
    return yaml.dump(value, Dumper=_Dumper, sort_keys=False, default_flow_style=False)
