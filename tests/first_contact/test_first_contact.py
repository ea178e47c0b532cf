# SPDX-License-Identifier: MIT
"""First contact with simulated robots in virtual time; $ROBUROC4_SIM_LIBRARY is the simulator."""

import json
import os
import signal
import struct
import sys
import unittest
from contextlib import suppress
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).parent))

from family import contact_with, wrong
from member import Library, VirtualWorld

from roburoc4_tools.cli.keyboard import Key
from roburoc4_tools.cli.signals import Signalled
from roburoc4_tools.first_contact.contact import Contact
from roburoc4_tools.first_contact.session import ReleasedError, Session, number
from roburoc4_tools.first_contact.terminal import TerminalWorld

DRIVEN, REFUSED = 10, 7
"""Seeds: a robot that is driven to the end, and one that does not report its inputs."""


def commands(s: Session) -> list[tuple[float, tuple[float, float]]]:
    """Return all speeds that were sent, and when."""
    head = b"\xff" + s.ids["differential"].to_bytes(2, "little")
    return [
        (at_s, struct.unpack_from("<2f", data, 3))
        for at_s, _port, out, data in s.log
        if out and data[:3] == head
    ]


class FirstContact(unittest.TestCase):
    """What a person with docs/first-contact.md is promised."""

    def setUp(self) -> None:
        self.library = Library(Path(os.environ["ROBUROC4_SIM_LIBRARY"]))

    def contact(self, seed: int, **changes: float) -> Contact:
        config, drawn = self.library.member(seed, **changes)
        return Contact(VirtualWorld(self.library, config, bool(drawn["other_status_port"])))

    def driving(self) -> Session:
        """Return a session in which the robot drives."""
        contact = self.contact(DRIVEN)
        for step in contact.steps():
            if step.name == "responses":
                break
        contact.session.run(1.0, (0.1, 0.0))
        return contact.session

    def test_what_is_measured_is_what_was_drawn(self) -> None:
        for seed in (0, 2, 3, 5, DRIVEN, 11, 47):
            with self.subTest(seed=seed):
                contact, member = contact_with(self.library, seed)
                assert wrong(contact, member) == []

    def test_a_simulator_with_the_robot_file_is_that_robot(self) -> None:
        contact, member = contact_with(self.library, DRIVEN)
        simulated = self.library.of_robot_file(contact.session.known)
        for name, value, tolerance in (*member.answers(), *member.on_wheels()):
            if name in simulated:
                assert abs(simulated[name] - value) <= tolerance + 1e-6, name
        assert simulated["input_shift"] == member.t["input_shift"]
        assert abs(simulated["watchdog_cycles"] - member.t["watchdog_cycles"]) <= 5

    def test_an_interrupted_contact_goes_on_where_it_was(self) -> None:
        whole, _member = contact_with(self.library, DRIVEN)
        first = self.contact(DRIVEN)
        for step in first.steps():
            if step.name == "watchdog":
                break
        second = Contact(first.session.world)
        second.resume(json.loads(json.dumps(first.state())))
        names = [step.name for step in second.steps()]
        assert names[0] == "watchdog"
        assert whole.session.known.keys() == second.session.known.keys()
        assert second.refused is None

    def test_nothing_moves_unless_the_key_is_held(self) -> None:
        contact = self.contact(DRIVEN)
        world = contact.session.world
        world.holds = False
        spoken = [step.name for step in contact.steps() if step.name == "stops"]
        assert spoken == ["stops"]
        assert "hold" in world.asked

    def test_letting_go_stops_the_robot_and_repeats_the_step(self) -> None:
        contact = self.contact(DRIVEN)
        world, s = contact.session.world, contact.session
        for step in contact.steps():
            if step.name == "responses":
                world.let_go_at_s = world.now_s + 2.0
            if step.name == "reports":
                break
        assert "again" in world.asked
        let_go_s = world.let_go_at_s
        sent = [v for at_s, v in commands(s) if let_go_s < at_s < world.held_again_s]
        assert len(sent) > 3
        assert not any(map(any, sent))

    def test_letting_go_stops_the_robot_while_no_commands_are_sent_too(self) -> None:
        s = self.driving()
        s.world.let_go_at_s = s.world.now_s + 0.2
        with suppress(ReleasedError):
            s.run(2.0, None)
        after = [speeds for at_s, speeds in commands(s) if at_s > s.world.let_go_at_s]
        assert len(after) > 3
        assert not any(map(any, after))

    def test_all_zeros_are_sent_however_often_somebody_interrupts(self) -> None:
        for interruption in (KeyboardInterrupt, Signalled(signal.SIGTERM), OSError):
            with self.subTest(interruption=interruption):
                s = self.driving()
                before = len(commands(s))
                with mock.patch.object(s.world, "wait", side_effect=interruption):
                    s.leave()
                assert [speeds for _at_s, speeds in commands(s)[before:]] == 5 * [(0.0, 0.0)]

    def test_a_terminal_that_is_gone_interrupts_once_and_holds_no_key(self) -> None:
        keyboard = mock.Mock(reports_releases=False)
        keyboard.keys.return_value = [Key(" ", "press")]
        world = TerminalWorld("127.0.0.1", 9, keyboard)
        assert world.held()
        keyboard.keys.side_effect = Signalled(signal.SIGHUP)
        gone = 0
        for _ in range(3):
            try:
                world.wait(0.01)
            except Signalled:
                gone += 1
        assert gone == 1
        assert not world.held()

    def test_no_speed_beyond_the_limits_is_sent_unless_the_wheels_have_no_power(self) -> None:
        contact = self.contact(DRIVEN)
        world, s = contact.session.world, contact.session
        please = world.please
        for step in contact.steps():
            if step.name == "motors":
                world.please = lambda key, text: key == "estop_press" or please(key, text)
        assert contact.refused is not None
        assert contact.refused.reason == "no_emergency_stop"
        assert max(abs(speeds[0]) for _at_s, speeds in commands(s)) <= 0.6
        assert commands(s)[-1][1] == (0.0, 0.0)

    def test_what_is_no_number_is_asked_again(self) -> None:
        answers = iter(["a metre", "", "nan", "1,25"])
        asked = []

        def ask(text: str) -> str:
            asked.append(text)
            return next(answers)

        assert number(ask, "How many metres?") == 1.25
        assert asked[1] == "'a metre' is no number; give one such as 1.25. How many metres?"

    def test_a_robot_that_endangers_is_refused_with_the_reason(self) -> None:
        for change, reason in (
            ({"hidden_services": 64}, "no_differential"),
            ({"digital_inputs": 5}, "no_game_pad"),
            ({"refused_inserts": 4}, "no_inputs"),
            ({"max_subscriptions": 1}, "list_full"),
            ({"queue_uplink_ms": 400, "queue_differential_ms": 300}, "late"),
            ({"watchdog_cycles": 3000}, "slow_watchdog"),
            ({"odometry_mirrored": 1}, "odometry"),
        ):
            with self.subTest(reason=reason):
                contact = self.contact(DRIVEN, **change)
                moved = [step.name for step in contact.steps() if step.moves]
                assert contact.refused is not None
                assert contact.refused.reason == reason
                if reason.startswith("no_") or reason == "list_full":
                    assert moved == []


if __name__ == "__main__":
    unittest.main()
