# SPDX-License-Identifier: MIT
"""A picture of the robot for RViz: its main dimensions, wheels, and where the telemeters are."""

import math
from xml.etree import ElementTree as Xml

from roburoc4.records import Properties

from .odometry import Frames
from .topics import RANGES

# The manual's (2.2); the wheels are not in it, and only for display.
_LENGTH_M, _WIDTH_M, _HEIGHT_M = 1.31, 0.75, 0.77
_WHEEL_RADIUS_M, _WHEEL_WIDTH_M = 0.28, 0.16
_CLEARANCE_M = 0.25
_TRACK_M = _WIDTH_M - _WHEEL_WIDTH_M
_WHEELBASE_M = _LENGTH_M - 2 * _WHEEL_RADIUS_M
_SENSOR_M = 0.05
_COLOURS = {"body": "0.9 0.65 0.1 1", "black": "0.1 0.1 0.1 1"}


def urdf(frames: Frames, properties: Properties) -> str:
    """Describe the robot; its links are the frames, and the base's is on the ground."""
    root = Xml.Element("robot", name="roburoc4")
    for name, colour in _COLOURS.items():
        Xml.SubElement(Xml.SubElement(root, "material", name=name), "color", rgba=colour)
    base = frames.named(frames.base)
    link = Xml.SubElement(root, "link", name=base)
    body_m = _HEIGHT_M - _CLEARANCE_M
    body = _visual(link, "body", (0.0, 0.0, _CLEARANCE_M + body_m / 2))
    size = f"{_LENGTH_M} {_WIDTH_M - 2 * _WHEEL_WIDTH_M} {body_m:g}"
    Xml.SubElement(body, "box", size=size)
    track_m = _track_m(properties)
    for x in (_WHEELBASE_M / 2, -_WHEELBASE_M / 2):
        for y in (track_m / 2, -track_m / 2):
            place = (x, y, _WHEEL_RADIUS_M)
            wheel = _visual(link, "black", place, f"{math.pi / 2} 0 0")
            Xml.SubElement(
                wheel, "cylinder", radius=str(_WHEEL_RADIUS_M), length=str(_WHEEL_WIDTH_M)
            )
    for name, one in zip(RANGES, properties.telemeter, strict=False):
        frame = frames.named(f"range_{name}")
        sensor = _visual(Xml.SubElement(root, "link", name=frame), "black", (0.0, 0.0, 0.0))
        Xml.SubElement(sensor, "sphere", radius=str(_SENSOR_M))
        joint = Xml.SubElement(root, "joint", name=f"{base}_to_{frame}", type="fixed")
        Xml.SubElement(joint, "parent", link=base)
        Xml.SubElement(joint, "child", link=frame)
        _origin(joint, (one.x_m, one.y_m, 0.0), f"0 0 {one.theta_rad:g}")
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _track_m(properties: Properties) -> float:
    reported = properties.differential.width_m if properties.differential else 0.0
    return reported if 0.0 < reported < 2 * _WIDTH_M else _TRACK_M


def _visual(
    link: Xml.Element, colour: str, place: tuple[float, float, float], turned: str = "0 0 0"
) -> Xml.Element:
    """Add something visible; return the element for its shape."""
    visual = Xml.SubElement(link, "visual")
    _origin(visual, place, turned)
    geometry = Xml.SubElement(visual, "geometry")
    Xml.SubElement(visual, "material", name=colour)
    return geometry


def _origin(parent: Xml.Element, place: tuple[float, float, float], turned: str) -> None:
    Xml.SubElement(parent, "origin", xyz=" ".join(f"{one:g}" for one in place), rpy=turned)
