# SPDX-License-Identifier: MIT
"""What a robot reports: statuses, properties, names; and commands other than motion."""

import math

import pytest

import roburoc4
from roburoc4 import BatteryState, LocalizationFlag, Service, Simulator


def test_statuses_are_typed_records_with_the_simulators_values(
    roburoc4_simulator: Simulator,
) -> None:
    roburoc4_simulator.set("battery_percent", 42)
    with roburoc4_simulator.connect() as robot:
        battery = robot.battery
        assert isinstance(battery, roburoc4.BatteryStatus)
        assert battery.remaining_percent == 42
        assert battery.state is BatteryState.OK
        assert battery.state_name == "ok"
        assert robot.localization.flags & LocalizationFlag.METRIC
        assert isinstance(robot.localization.flags, LocalizationFlag)
        assert len(robot.telemeter.distances_m) == 2
        assert robot.differential.current_linear_m_s == 0
        assert len(robot.iocard.analog_inputs) == 9
        assert robot.battery.host_us <= robot.now_s * 1e6


def test_unknown_values_name_the_remedy(roburoc4_simulator: Simulator) -> None:
    robot = roburoc4_simulator.connect(period_ms={"battery": None})
    with robot, pytest.raises(roburoc4.NotKnownError, match=r"wait_for\('battery'\)") as caught:
        _ = robot.battery
    assert caught.value.code == roburoc4.Result.NOT_KNOWN


def test_properties_have_everything_the_robot_reported(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        properties = robot.properties
        assert [entry.service for entry in properties.services] == [
            service.name.lower() for service in Service
        ]
        assert properties.services[2].name == "IOCard"
        assert properties.battery is not None
        assert properties.battery.nominal_voltage_v == 24
        assert properties.iocard == (9, 0, 22, 8)
        assert properties.differential is not None
        assert math.isclose(properties.differential.max_linear_m_s, 2.6, rel_tol=1e-6)
        assert math.isclose(properties.differential.width_m, 0.68, rel_tol=1e-6)
        assert [round(t.theta_rad, 3) for t in properties.telemeter] == [0, 3.142]


def test_what_is_not_known_is_none(roburoc4_simulator: Simulator) -> None:
    facts = "overridden", "front_bumper", "rear_bumper", "battery_low"
    with Simulator(digital_inputs=0) as sim, sim.connect() as robot:
        robot.wait_for("iocard")
        robot.sleep(5.0)
        assert robot.facts.overridden is None
        assert robot.facts.front_bumper is None
        assert robot.facts.rear_bumper is None
        assert robot.facts.battery_low is False
    with roburoc4_simulator.connect() as robot:
        assert {getattr(robot.facts, fact) for fact in facts} == {None}
        robot.wait_for("iocard")
        robot.wait_for("battery")
        assert {getattr(robot.facts, fact) for fact in facts} == {False}
        roburoc4_simulator.set("front_bumper", True)
        robot.wait_for(lambda r: r.facts.front_bumper)


def test_services_without_statuses_are_listed_as_missing() -> None:
    with (
        Simulator(
            hidden_services=1 << Service.BATTERY, refused_inserts=1 << Service.TELEMETER
        ) as sim,
        sim.connect() as robot,
    ):
        robot.sleep(5.0)
        assert robot.facts.missing == (Service.TELEMETER, Service.BATTERY)


def test_values_have_an_age(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        assert robot.age_s("battery") is None
        robot.wait_for("battery")
        age_s = robot.age_s("battery")
        assert age_s is not None
        roburoc4_simulator.set("power", False)
        robot.sleep(3.0)
        assert robot.age_s("battery") == pytest.approx(age_s + 3.0, abs=0.1)


def test_services_can_be_named_by_their_ids(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect(iocard_id=2, differential_id=6) as robot:
        robot.arm()
    for name in ("iocard_id", "differential_id"):
        with pytest.raises(roburoc4.ArgumentError, match=f"{name}: 1 .* give -1, or 2 to 65535"):
            roburoc4.connect("127.0.0.1", wait=False, **{name: 1})  # type: ignore[arg-type]


def test_errors_for_unknown_names_list_the_known_ones(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        with pytest.raises(roburoc4.ArgumentError, match="Front bumper"):
            _ = robot.inputs["Coffee machine"]
        with pytest.raises(roburoc4.ArgumentError, match="0 to 21"):
            robot.inputs.digital(22)
        with pytest.raises(roburoc4.ArgumentError, match="no analog outputs"):
            robot.analog_outputs[0] = 1.0


def test_outputs_reach_the_robot_and_output_0_is_its_own(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.digital_outputs[3] = True
        robot.digital_outputs.set({4: True, 5: False})
        assert [roburoc4_simulator.get(f"digital_output_{i}") for i in (3, 4, 5)] == [
            True,
            True,
            False,
        ]
        assert robot.digital_outputs[3]
        with pytest.raises(roburoc4.ArgumentError, match="output 1 or above"):
            robot.digital_outputs[0] = True
        with pytest.raises(roburoc4.ArgumentError, match="0 to 7"):
            robot.digital_outputs[8] = True
        assert len(robot.digital_outputs) == 8


def test_analog_outputs_reach_the_robot() -> None:
    with Simulator(analog_outputs=2) as sim, sim.connect() as robot:
        robot.analog_outputs[1] = 2.5
        assert robot.analog_outputs[1] == 2.5
        assert sim.state.io_commands > 0
        with pytest.raises(roburoc4.ArgumentError, match="nan"):
            robot.analog_outputs[1] = math.nan


def test_relocalize_waits_until_the_robot_has_accepted_it(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.relocalize(3.0, -4.0, 1.5)
        assert robot.localization[1:4] == (3.0, -4.0, 1.5)
        robot.subscribe("localization", 500)
        robot.sleep(1.1)
        robot.relocalize(5.0, 6.0, 0.5)
        assert robot.localization[1:4] == (5.0, 6.0, 0.5)
        robot.unsubscribe("localization")
        robot.relocalize(1.0, 2.0, 0.5)  # no pose will come to confirm it
        with pytest.raises(roburoc4.ArgumentError):
            robot.relocalize(math.inf, 0, 0)
        with pytest.raises(roburoc4.ArgumentError, match=r"90 .*radians \(not degrees\)"):
            robot.relocalize(0, 0, 90)


def test_the_link_has_figures(roburoc4_simulator: Simulator) -> None:
    roburoc4_simulator.set_faults(delay_ms=5)
    with roburoc4_simulator.connect() as robot:
        robot.sleep(2.0)
        assert 9_000 < robot.link.round_trip_us < 30_000
        figures = robot.service_link("localization")
        assert figures.subscribed
        assert figures.period_us == 50_000
        assert figures.received >= 38
        assert figures.lost == 0
        assert robot.counts[roburoc4.Count.RECEIVED] > 100
        assert robot.fault is roburoc4.Fault.NONE
        assert abs(robot.host_time_s(robot.localization.robot_cycles) - robot.now_s) < 0.1


def test_subscriptions_can_be_changed(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.subscribe("battery", 100)
        before = robot.service_link("battery").received
        robot.sleep(1.0)
        assert robot.service_link("battery").received - before >= 8
        robot.unsubscribe("battery")
        assert not robot.service_link("battery").subscribed
        with pytest.raises(roburoc4.ArgumentError):
            robot.subscribe("battery", 15)
        with pytest.raises(roburoc4.ArgumentError, match="localization"):
            robot.subscribe("coffee", 100)
