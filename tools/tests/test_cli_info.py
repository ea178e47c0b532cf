# SPDX-License-Identifier: MIT
"""`roburoc4 info`: all that the robot reports about itself, for people and as JSON."""

import re

from cli_support import document, one_line, run

import roburoc4

DIFFERENTIAL = {
    "target_linear_m_s": 0.0,
    "target_angular_rad_s": 0.0,
    "current_linear_m_s": 0.0,
    "current_angular_rad_s": 0.0,
    "max_linear_m_s": 2.6,
    "min_linear_m_s": -2.6,
    "max_angular_rad_s": 6.5,
    "min_angular_rad_s": -6.5,
    "max_linear_m_s2": 3.0,
    "min_linear_m_s2": -3.0,
    "max_angular_rad_s2": 8.0,
    "min_angular_rad_s2": -8.0,
    "width_m": 0.68,
}


def test_json_has_every_property_under_its_name_and_unit() -> None:
    with roburoc4.Simulator(port=0) as sim:
        info = document(run("info", "--json", robot=sim.address))
    assert list(info) == [
        "robot",
        "services",
        "iocard",
        "telemeter",
        "battery",
        "localization",
        "differential",
        "channels",
        "missing",
    ]
    assert info["missing"] == []
    assert info["robot"] == sim.address
    assert info["iocard"] == {
        "analog_inputs": 9,
        "analog_outputs": 0,
        "digital_inputs": 22,
        "digital_outputs": 8,
    }
    assert info["battery"] == {
        "nominal_voltage_v": 24.0,
        "capacity_ah": 60.0,
        "minimum_percent": 20,
    }
    assert info["localization"] == {"x_m": 0.0, "y_m": 0.0, "theta_rad": 0.0, "flags": 18}
    assert info["differential"] == DIFFERENTIAL
    assert len(info["telemeter"]) == 2
    front = info["telemeter"][0]
    assert front["x_m"] == 0.655
    assert set(front) == {
        "x_m",
        "y_m",
        "theta_rad",
        "field_of_view_rad",
        "min_distance_m",
        "max_distance_m",
        "distance_m",
    }


def test_json_lists_services_with_their_ids_and_channels_by_name() -> None:
    with roburoc4.Simulator(port=0, iocard_id=12, battery_id=3, telemeter_id=40) as sim:
        info = document(run("info", "--json", robot=sim.address))
    ids = {service["service"]: service["id"] for service in info["services"]}
    assert ids == {
        "directory": 0,
        "notification": 1,
        "localization": 5,
        "differential": 6,
        "iocard": 12,
        "battery": 3,
        "telemeter": 40,
    }
    for service in info["services"]:
        assert set(service) == {"id", "type", "service", "name"}
        assert service["name"]
    channels = info["channels"]
    assert channels["digital_inputs"][0] == "Front bumper"
    assert channels["digital_inputs"][8] == 'Game pad "A" button'
    assert channels["analog_inputs"][2] == "Battery voltage"
    assert channels["analog_outputs"] == []
    assert [len(names) for names in channels.values()] == [9, 0, 22, 8]


def test_missing_texts_are_reported_and_not_an_error() -> None:
    with roburoc4.Simulator(port=0, query_mode=1) as sim:
        done = run("info", "--json", robot=sim.address)
    assert "no more texts" in one_line(done.stderr)
    assert document(done)["channels"]["digital_inputs"][1] == "Rear bumper"


def test_a_service_that_the_robot_lacks_is_null() -> None:
    with roburoc4.Simulator(port=0, hidden_services=1 << 4 | 1 << 3) as sim:
        info = document(run("info", "--json", robot=sim.address))
    assert info["battery"] is None
    assert info["telemeter"] is None
    assert info["iocard"] is not None


def test_people_get_names_values_and_units() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("info", robot=sim.address)
    assert (done.returncode, done.stderr) == (0, "")
    for text in (r"max linear +2\.6 m/s", "nominal voltage +24 V", "0 +Front bumper"):
        assert re.search(text, done.stdout)
