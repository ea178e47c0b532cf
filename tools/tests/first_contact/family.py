# SPDX-License-Identifier: MIT
"""First contact with drawn members of the family: is what was measured what was drawn?

family.py --library SIM.so [--seeds FIRST:END]. The simulator, which draws them, is C; the
measuring program shares no code with it.
"""

import argparse
import cmath
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "src")]

from member import Library, VirtualWorld  # noqa: E402

from roburoc4_tools.first_contact.contact import Contact  # noqa: E402

SERVICES = ("iocard", "telemeter", "battery", "localization", "differential")
IMMEDIATE_RAD_S = 1000
FASTEST = 2.5
"""m/s or rad/s that no step asks for: a robot whose limit of acceleration is far below what its
response needs swings higher and higher."""
LATEST_MS = 450
_PLAIN_TYPE = 0x7100


class Member:
    """What a contact with this robot must find out, as far as anybody can from outside."""

    def __init__(self, drawn: dict[str, float]) -> None:
        self.t = dict(drawn)
        hidden, refused = int(drawn["hidden_services"]), int(drawn["refused_inserts"])
        self.there = [n for k, n in enumerate(SERVICES) if not hidden >> (k + 2) & 1]
        self.usable = [
            n for k, n in enumerate(SERVICES) if n in self.there and not refused >> (k + 2) & 1
        ]
        shift = int(drawn["input_shift"]) + (drawn["digital_inputs"] == 23)
        self.a_index = 8 + shift
        self.inputs = int(drawn["digital_inputs"]) if "iocard" in self.there else 0
        self.shift = shift

    def refusals(self) -> set[str | None]:
        """Return the reasons that are right, in the order of the steps; several on a border."""
        t = self.t
        if "iocard" not in self.usable:
            return {"no_inputs"}
        if self.a_index >= min(self.inputs, 64):
            return {"no_game_pad"}
        if "differential" not in self.there:
            return {"no_differential"}
        if "differential" not in self.usable:
            return {"no_speeds"}
        if t["max_subscriptions"] < 2:
            return {"list_full"}
        found: set[str | None] = set()
        for service in ("iocard", "differential"):
            late_ms = t["queue_uplink_ms"] + t[f"queue_{service}_ms"]
            if late_ms - self._queue_within_ms() > LATEST_MS:
                return {"late"}
            if late_ms + self._queue_within_ms() > LATEST_MS:
                found.add("late")
        late_ms = t["queue_uplink_ms"] + t["queue_differential_ms"]
        late_ms += 10 * t["dead_time_cycles"] * t["late_targets"]
        least_ms = late_ms
        most_ms = late_ms + 10 * t["min_period_cycles"] + 10 * t["odometry_period_cycles"] + 20
        if most_ms > LATEST_MS:
            found.add("late")
        if least_ms > LATEST_MS:
            return found
        if t["watchdog_cycles"] > 205:
            return found | {"slow_watchdog"}
        if t["watchdog_cycles"] >= 200:
            found.add("slow_watchdog")
        scale = t["odometry_scale"]
        if "localization" not in self.usable:
            return found | {"no_localization"}
        if not 0.49 <= scale <= 2 or t["odometry_mirrored"]:
            return found | {"odometry"}
        return found | ({"odometry"} if scale < 0.51 else set()) | {None}

    def _queue_within_ms(self) -> float:
        """Return how well a queue is found: a status leaves within a period and a cycle of it."""
        return 5 * (self.t["min_period_cycles"] + 3)

    def _texts(self) -> tuple[int, int]:
        """Return which bits can be seen, and what they are."""
        mode = self.t["query_mode"]
        seen = 0 if mode == 1 else 16 if mode in (2, 5) else 17
        if mode in (0, 3, 4):
            seen |= 2 if self.inputs > self.a_index + 1 else 0
            seen |= 4 if self.inputs > 2 + self.shift else 0
            seen |= 8 if self.inputs > 3 + self.shift else 0
        return seen, int(self.t["texts"]) & seen

    def answers(self) -> Iterator[tuple[str, float, float]]:
        """Yield each question that has an answer from outside: name, answer, tolerance."""
        yield from self._identity()
        yield from self._subscriptions()

    def _identity(self) -> Iterator[tuple[str, float, float]]:
        t = self.t
        for k, service in enumerate(SERVICES):
            if service in self.there:
                yield f"{service}_id", t[f"{service}_id"], 0
                plain = _PLAIN_TYPE + 2 + k
                yield f"{service}_type", plain if t["plain_types"] else t[f"{service}_type"], 0
        yield "hidden_services", t["hidden_services"], 0
        yield "only_id_fixed", t["only_id_fixed"], 0
        if not t["only_id_fixed"]:
            yield "answer_id_fixed", t["answer_id_fixed"], 0
        yield "error_header", t["error_header"], 0
        if t["error_header"] != 2:
            yield "error_code", t["error_code"], 0
        asks_a = "iocard" in self.there and self.a_index < self.inputs
        mode = t["query_mode"]
        yield "query_mode", 0 if mode in (3, 4) and not asks_a else mode, 0
        if "iocard" in self.there:
            for name in ("analog_inputs", "analog_outputs", "digital_inputs", "digital_outputs"):
                yield name, t[name], 0
        if "telemeter" in self.there:
            yield "telemeters", t["telemeters"], 0
            if t["telemeters"]:
                yield "telemeter_turn_rad", t["telemeter_turn_rad"], 1e-3

    def _subscriptions(self) -> Iterator[tuple[str, float, float]]:
        t, usable = self.t, self.usable
        mask = int(t["refused_inserts"]) & ~int(t["hidden_services"])
        yield "refused_inserts", mask, 0
        yield "min_period_cycles", t["min_period_cycles"], 0
        yield "delete_refused", t["delete_refused"], 0
        yield "keep_subscriptions", t["keep_subscriptions"], 0
        yield "other_status_port", t["other_status_port"], 0
        if set(usable) - {"telemeter"}:
            yield "surplus_bytes", t["surplus_bytes"], 0
            if "telemeter" in usable:
                yield "reported_distances", min(t["telemeters"], t["reported_distances"]), 0
        for service in usable:
            late_ms = t["queue_uplink_ms"] + t[f"queue_{service}_ms"]
            yield f"queue_{service}_ms", late_ms, self._queue_within_ms()
        most = t["max_subscriptions"]
        if most > 1:
            yield "subscription_lists", t["subscription_lists"], 0
        for_all = t["subscription_lists"] == 2  # then a list has one place for each service
        full = most < (len(usable) if for_all else 30)
        if full or not for_all:
            yield "max_subscriptions", most if full else 448, 0
        if full:
            yield "full_list", t["full_list"], 0

    def by_hand(self) -> Iterator[tuple[str, float, float]]:
        """Yield what a person finds out at the inputs."""
        t = self.t
        if self.inputs > 0:
            yield "front_bumper_index", 0, 0
        if self.inputs > 1:
            yield "rear_bumper_index", 1, 0
        if self.a_index < self.inputs:
            yield "override_index", self.a_index, 0
        analog = 2 + t["input_shift"] + (t["analog_inputs"] == 10)
        if analog < t["analog_inputs"]:
            yield "battery_voltage_index", analog, 0

    def on_wheels(self) -> Iterator[tuple[str, float, float]]:
        """Yield what the wheels show."""
        t = self.t
        for axis in ("linear", "angular"):
            omega = t[f"{axis}_omega_rad_s"]
            yield f"{axis}_omega_rad_s", omega, 0.1 * omega
            if omega < 1000:
                yield f"{axis}_damping", t[f"{axis}_damping"], 0.1 * t[f"{axis}_damping"]
            yield f"{axis}_gain", t[f"{axis}_gain"], 0.02
        yield "dead_time_cycles", t["dead_time_cycles"], 0
        yield "late_targets", t["late_targets"], 0
        yield "speed_noise", t["speed_noise"], max(0.1 * t["speed_noise"], 7e-4)
        for name in ("linear_m_s", "angular_rad_s", "linear_m_s2", "angular_rad_s2"):
            for end in ("max", "min"):
                yield f"{end}_{name}", t[f"{end}_{name}"], 1e-4
        yield "width_m", t["width_m"], 1e-4
        yield "robot_watchdog_ms", 10 * t["watchdog_cycles"], 50
        if not t["late_targets"]:
            yield "tripped_target_shown", t["tripped_target_shown"], 0
        yield "pad_keeps_target", t["pad_keeps_target"], 0
        if t["pad_keeps_target"] == 2:
            yield "ignored_commands_feed", t["ignored_commands_feed"], 0
        yield "pad_target_hidden", t["pad_target_hidden"], 0
        yield "commands_need_motors", t["commands_need_motors"], 0
        if not t["commands_need_motors"]:
            yield "over_limit_refused", t["over_limit_refused"], 0
        yield "start_safe", t["start_safe"], 0
        # Queued statuses leave the simulator at its cycles: 10 ms within a minute.
        yield "clock_ppm", t["clock_ppm"], 200 if t["queue_iocard_ms"] else 5
        period = t["odometry_period_cycles"]
        if t["min_period_cycles"] == 1:
            yield "odometry_period_cycles", period, 0
            if period > 1:
                yield "stamp_measured", t["stamp_measured"], 0
        if "localization" in self.usable:
            yield "replace_mode", t["replace_mode"], 0
            yield "odometry_scale", t["odometry_scale"], max(0.02, 0.02 * abs(t["odometry_scale"]))
            if abs(t["odometry_scale"]) > 0.06:
                yield "odometry_mirrored", t["odometry_mirrored"], 0


def contact_with(library: Library, seed: int) -> tuple[Contact, Member]:
    """Make first contact with the member of this seed."""
    config, drawn = library.member(seed)
    world = VirtualWorld(library, config, bool(drawn["other_status_port"]))
    contact = Contact(world)
    for _step in contact.steps():
        pass
    return contact, Member(drawn)


def _is_hidden(contact: Contact, member: Member, name: str) -> bool:
    """Whether a frequency cannot be told from others: the step is reproduced within 1 %.

    So it is where a response is over within a cycle, or where the limit of acceleration hides it.
    Noise hides it too where it is over within a cycle but for 2 %: then it is called immediate.
    """
    axis = {"linear": 0, "angular": 1}.get(name.partition("_")[0], 2)
    if axis not in contact.session.responses or not name.endswith(("omega_rad_s", "damping")):
        return False
    response = contact.session.responses[axis]
    if response.omega_rad_s >= IMMEDIATE_RAD_S and _left_after_a_cycle(member, axis) < 0.02:
        return True
    return response.omega_rad_s > 60 and response.misfit < 0.01


def _left_after_a_cycle(member: Member, axis: int) -> float:
    """Return which share of a step is left after a cycle of 10 ms, as drawn."""
    name = ("linear", "angular")[axis]
    omega, damping = member.t[f"{name}_omega_rad_s"], member.t[f"{name}_damping"]
    root = cmath.sqrt(damping**2 - 1 + 1e-9)
    slow, fast = ((-damping + sign * root) * omega for sign in (1, -1))
    left = (slow * cmath.exp(0.01 * fast) - fast * cmath.exp(0.01 * slow)) / (slow - fast)
    return abs(left)


def wrong(contact: Contact, member: Member) -> list[str]:
    """Return what was measured otherwise than drawn."""
    known, done = contact.session.known, contact.done
    expected = [*member.answers()]
    reason = contact.refused.reason if contact.refused else None
    if "inputs" in done:
        expected += member.by_hand()
    if "odometry" in done:
        expected += member.on_wheels()
    found = [
        f"{name}: {known.get(name)} for {value:g}"
        for name, value, tolerance in expected
        if (name not in known or abs(known[name] - value) > tolerance)
        and not _is_hidden(contact, member, name)
    ]
    right = {"runs_away"} if contact.session.world.fastest > FASTEST else member.refusals()
    if reason not in right:
        found.append(f"refused: {reason} for {sorted(map(str, right))}")
    return found


def main() -> int:
    """Try the seeds; the exit status is 1 if any answer is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--library", type=Path, required=True)
    parser.add_argument("--seeds", default="0:40", help="FIRST:END")
    options = parser.parse_args()
    library = Library(options.library)
    first, end = map(int, options.seeds.split(":"))
    right, reasons, blamed = 0, Counter[str](), Counter[str]()
    for seed in range(first, end):
        contact, member = contact_with(library, seed)
        reason = contact.refused.reason if contact.refused else "driven"
        reasons[reason] += 1
        found = wrong(contact, member)
        right += not found
        blamed.update(each.partition(":")[0] for each in found)
        minutes = contact.session.world.now_s / 60
        print(f"{seed}: {reason}, {minutes:.0f} min: {'; '.join(found) or 'as drawn'}", flush=True)
    print(f"{right} of {end - first} as drawn; {dict(reasons)}; wrong: {dict(blamed)}")
    return int(right < end - first)


if __name__ == "__main__":
    sys.exit(main())
