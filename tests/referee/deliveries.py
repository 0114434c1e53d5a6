"""Which delivery a connection has, how much its writer keeps, and whether it loses.

`wire_of` makes a wire of its ends, the entry of the file and what the model's file says of itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from language import Refused

LATE, AT_ONCE, ACKNOWLEDGED = "late", "at_once", "acknowledged"
MOST = 10  # messages on one wire, or the depth of a writer that keeps more

KEEP_LAST = {"ros2", "cyclonedds", "fastdds"}
LATE_MIDDLEWARE = {"ros1", "ros2", "cyclonedds", "fastdds", "zeromq", "mqtt"}
UNBUFFERED_LATE = {"udp", "mcast", "fast_tcp"}  # carriers of YARP that do not wait


@dataclass(frozen=True)
class Wire:
    """What was sent by one entry and has not arrived at one box."""

    entry: int
    box: int
    keep: int | None  # the newest of which none is lost; None: no message is lost
    delivery: str = LATE
    loses: bool = False
    stream: str | None = None

    def most(self) -> int:
        """How many messages it holds."""
        return MOST if self.keep is None else max(self.keep, MOST)


class Origin:
    """What an entry of the file, or its model's file, says of the middleware."""

    def __init__(self, description: dict, sul: str) -> None:
        words = sul.split()
        self.name = str(description.get("learn") or (words[0] if words else ""))
        self.said = dict(word.split("=", 1) for word in words[1:] if "=" in word)
        if "learn" in description:
            self.said = {}
        self.use = description.get("use")
        self.bare = not {"use", "file", "learn"} & set(description)
        self.options = {str(k).replace("_", "-"): v for k, v in options_of(description).items()}

    def value(self, *keys: str) -> Any:
        """The first of these that the entry says, or else its model's file; `both` is no value."""
        for said in (self.options, self.said):
            for key in keys:
                if key in said and said[key] != "both":
                    return said[key]
        return None

    def hands_over(self) -> bool:
        """Whether it was measured that a write in the same process hands the message over."""
        if self.name == "ros2":
            return self.is_cyclone()
        transport = self.value("transport")
        if self.name == "ros1":
            return transport == "intraprocess"
        if self.name == "zeromq":
            return transport in (None, "inproc") and self.value("pattern") != "req-rep"
        return self.name == "cyclonedds" or self.name == "fastdds" and transport != "udp"


    def is_cyclone(self) -> bool:
        """Whether what is of ROS 2 goes over Cyclone DDS."""
        return self.value("rmw") in (None, "cyclonedds", "rmw_cyclonedds_cpp")


def options_of(description: dict) -> dict:
    """The options of an entry."""
    return description.get("with") or {}


def delivery_of(
    description: dict, origin: Origin, same_process: bool, is_topic: bool, has_node: bool
) -> str:
    """The delivery of a wire: what is said, or the first default that fits."""
    said = description.get("delivery")
    if said is not None:
        if said not in (LATE, AT_ONCE, ACKNOWLEDGED):
            raise Refused(f"delivery: {said}")
        return str(said)
    if origin.use == "queue" and "size" in origin.options and "pub-depth" not in origin.options:
        return AT_ONCE
    is_bare = has_node and origin.bare and origin.is_cyclone()
    if same_process and (origin.hands_over() or is_bare):
        return AT_ONCE
    if origin.name == "yarp":
        is_buffered = origin.value("kind") in ("buffered", "strict")
        is_late = is_buffered or origin.value("carrier") in UNBUFFERED_LATE
        return LATE if is_late else ACKNOWLEDGED
    return LATE if origin.name in LATE_MIDDLEWARE or is_topic else AT_ONCE


def kept(origin: Origin, is_service: bool, number: Any) -> int | None:
    """How many messages the writer keeps; None where it loses none."""
    history = origin.value("pub-history") or origin.value("history")
    says_last = "pub-depth" in origin.options or origin.options.get("pub-history") == "keep_last"
    is_last = (
        is_service
        or origin.use == "queue" and "depth" in origin.options
        or origin.name in KEEP_LAST
        or says_last
    )
    if not is_last or history == "keep_all":
        return None
    return int(number(origin.value("pub-depth", "depth") or 10))


def loses(description: dict, origin: Origin, own: dict) -> bool:
    """Whether messages may be lost: where it is said, or best effort is."""
    if "loses" in description:
        return bool(description["loses"])
    own = {str(k).replace("_", "-"): v for k, v in own.items()}
    keys = ("reliability", "pub-reliability", "sub-reliability")
    return any("best_effort" in (own.get(key), origin.value(key)) for key in keys)


def acknowledged_by_one(wire: Wire) -> Wire:
    """The wire of a connection with one reader."""
    return replace(wire, delivery=AT_ONCE) if wire.delivery == ACKNOWLEDGED else wire
