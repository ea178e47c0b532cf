# SPDX-License-Identifier: MIT
"""What each answer is, in plain words and with its unit. PROTOCOL.md's family says it at length."""

from typing import NamedTuple

from .wire import SERVICES


class Meaning(NamedTuple):
    """What an answer is."""

    phrase: str
    unit: str = ""


_AXES = {"linear": ("driving straight", "m/s"), "angular": ("turning", "rad/s")}
_ENDS = {
    "linear": {"max": "forward", "min": "backward"},
    "angular": {"max": "to the left", "min": "to the right"},
}

MEANINGS = {
    **{f"{name}_id": Meaning(f"id of the service {name}") for name in SERVICES},
    **{f"{name}_type": Meaning(f"type code of the service {name}") for name in SERVICES},
    **{
        f"queue_{name}_ms": Meaning(f"how late statuses of the {name} arrive", "ms")
        for name in SERVICES
    },
    "hidden_services": Meaning("missing services: the sum of 2^n, n is 2 (iocard) to 6"),
    "only_id_fixed": Meaning("requests are answered 0: whatever their id, 1: only with id 1"),
    "answer_id_fixed": Meaning("answers have 0: the request's id, 1: always id 1"),
    "error_header": Meaning("a failure comes as 0: an answer, 1: an error telegram, 2: one byte"),
    "error_code": Meaning("number of each error; 0: it depends on the cause"),
    "surplus_bytes": Meaning("after the known end of a status", "bytes"),
    "delete_refused": Meaning("a subscription ends 0: when asked, 1: only with a restart"),
    "replace_mode": Meaning("setting the pose is 0: obeyed, 1: refused, 2: without effect"),
    "analog_inputs": Meaning("how many analog inputs the IO card has"),
    "analog_outputs": Meaning("how many analog outputs the IO card has"),
    "digital_inputs": Meaning("how many digital inputs the IO card has"),
    "digital_outputs": Meaning("how many digital outputs the IO card has"),
    "override_index": Meaning("digital input of the game pad's [A], which takes control"),
    "front_bumper_index": Meaning("digital input of the front bumper"),
    "rear_bumper_index": Meaning("digital input of the rear bumper"),
    "battery_voltage_index": Meaning("analog input with the battery's voltage"),
    "query_mode": Meaning(
        "texts are 0: all given, 1: not answered, 2: refused, 3: given but [A]'s, which is not "
        "answered, 4: given but [A]'s, which is refused, 5: empty"
    ),
    "texts": Meaning(
        "how texts differ from the manual's, a sum: 1 other order, 2 Latin-1 quotes, 4 two front "
        "bumpers, 8 two that resemble [A], 16 sent twice"
    ),
    "queue_text_ms": Meaning("how much later than other answers texts arrive", "ms"),
    "queue_answer_ms": Meaning("how late answers arrive", "ms"),
    "telemeters": Meaning("how many telemeters there are"),
    "reported_distances": Meaning("how many of them report a distance"),
    "telemeter_turn_rad": Meaning("where the first one points, to the left of forward", "rad"),
    "refused_inserts": Meaning("services that send no statuses: the sum of 2^n, n is 2 to 6"),
    "subscription_lists": Meaning(
        "a subscription belongs to 0: who asked, 1: all who asked, 2: who asked last"
    ),
    "min_period_cycles": Meaning("shortest period of statuses", "cycles of 10 ms"),
    "max_subscriptions": Meaning("how many subscriptions fit in; 448: at least as many as tried"),
    "full_list": Meaning(
        "one more is 0: refused, 1: accepted without statuses, 2: accepted, the oldest one ends"
    ),
    "keep_subscriptions": Meaning("when a port is closed, its subscriptions 0: end, 1: stay"),
    "other_status_port": Meaning("statuses come from 0: the port of answers, 1: another one"),
    "robot_watchdog_ms": Meaning("after this long without commands the robot stops itself", "ms"),
    "tripped_target_shown": Meaning("after that it reports 0: no target, 1: the last target"),
    "pad_keeps_target": Meaning(
        "when [A] is let go it obeys 0: no target, 1: the last one sent meanwhile, 2: the one "
        "from before"
    ),
    "ignored_commands_feed": Meaning("commands during [A] keep the watchdog waiting, 1: yes"),
    "pad_target_hidden": Meaning("during [A] the game pad's target is 0: reported, 1: hidden"),
    "commands_need_motors": Meaning("without motor power commands are 0: kept, 1: ignored"),
    "over_limit_refused": Meaning("a speed beyond the limit is 0: limited, 1: ignored"),
    "start_safe": Meaning("after power on the motors have power 0: at once, 1: by the button"),
    **{
        f"{end}_{axis}_{unit.replace('/', '_')}{power}": Meaning(
            f"limit of {what} {way}, by its properties", unit + power.replace("2", "²")
        )
        for axis, (_doing, unit) in _AXES.items()
        for end, way in _ENDS[axis].items()
        for power, what in (("", "speed"), ("2", "acceleration"))
    },
    "width_m": Meaning("distance of the wheels, by its properties", "m"),
    **{
        f"{axis}_{name}": Meaning(f"{what} when {doing}", unit)
        for axis, (doing, _unit) in _AXES.items()
        for name, what, unit in (
            (
                "omega_rad_s",
                "natural frequency: how fast speeds follow; 1000: at once",
                "rad/s",
            ),
            ("damping", "damping: below 1 the speed overshoots", ""),
            ("gain", "final speed as a share of the target", ""),
        )
    },
    "dead_time_cycles": Meaning("before the motors follow a command", "cycles of 10 ms"),
    "late_targets": Meaning("a target is reported 0: at once, 1: when the motors follow"),
    "speed_noise": Meaning("noise of reported speeds, up to", "m/s and rad/s"),
    "odometry_period_cycles": Meaning("how often speeds and pose are measured", "cycles of 10 ms"),
    "stamp_measured": Meaning("statuses are stamped 0: when sent, 1: when measured"),
    "odometry_scale": Meaning("way by the pose, as a share of that by the speeds"),
    "odometry_mirrored": Meaning("the pose turns 0: as the robot does, 1: the other way"),
    "clock_ppm": Meaning("how much the robot's clock is fast", "ppm"),
    "scale_linear": Meaning("way that the robot counts, as a share of the real one"),
    "scale_angular": Meaning("angle that the robot counts, as a share of the real one"),
}


def meaning(name: str) -> Meaning:
    """Return what this answer is."""
    return MEANINGS.get(name, Meaning(""))


def shown(name: str, value: float) -> str:
    """Write an answer with its unit."""
    return f"{value:g} {meaning(name).unit}".rstrip()


def sentence(name: str, value: float) -> str:
    """Write an answer for the terminal."""
    return f"{name} = {shown(name, value)}: {meaning(name).phrase}"
