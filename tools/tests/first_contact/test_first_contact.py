# SPDX-License-Identifier: MIT
"""First contact with simulated robots in virtual time; $ROBUROC4_SIM_LIBRARY is the simulator."""

import getpass
import json
import math
import os
import random
import re
import signal
import struct
import sys
import tempfile
import unittest
import zipfile
from collections.abc import Iterator
from datetime import date
from itertools import islice, pairwise
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).parent))

from family import Member, contact_with, wrong
from member import Library, VirtualWorld

from roburoc4_tools.first_contact import answers, bundle
from roburoc4_tools.first_contact.contact import STEPS, Contact
from roburoc4_tools.first_contact.response import Response, fit, simulate
from roburoc4_tools.first_contact.session import Session, number
from roburoc4_tools.first_contact.terminal import TerminalWorld
from roburoc4_tools.terminal.keyboard import Key
from roburoc4_tools.terminal.signals import Signalled

HOST = "host-of-somebody"
"""Whatever this machine is called: a short name is in any recording by chance."""
DRIVEN = 10
"""The seed of a robot that is driven to the end."""


def commands(s: Session) -> list[tuple[float, tuple[float, float]]]:
    """Return all speeds that were sent, and when."""
    head = b"\xff" + s.ids["differential"].to_bytes(2, "little")
    return [
        (at_s, struct.unpack_from("<2f", data, 3))
        for at_s, _port, out, data in s.log
        if out and data[:3] == head
    ]


def packets(file: bytes) -> Iterator[tuple[float, bytes]]:
    """Yield when each datagram was recorded, in s, and its IPv4 header."""
    at = 0
    while at < len(file):
        kind, size = struct.unpack_from("<2I", file, at)
        if kind == 6:
            high, low = struct.unpack_from("<2I", file, at + 12)
            yield ((high << 32) + low) / 1e6, file[at + 28 : at + 48]
        at += size


class FirstContact(unittest.TestCase):
    """What a person with docs/first-contact.md is promised."""

    library: Library
    lasts: dict[str, tuple[int, float]]
    """How many waits, and seconds, each step takes."""
    whole: Contact
    """With a robot that is driven to the end."""
    member: Member

    @classmethod
    def setUpClass(cls) -> None:
        cls.library = Library(Path(os.environ["ROBUROC4_SIM_LIBRARY"]))
        config, drawn = cls.library.member(DRIVEN)
        cls.member = Member(drawn)
        world = VirtualWorld(cls.library, config, bool(drawn["other_status_port"]))
        cls.whole = Contact(world)
        for function in ("platform.node", "socket.gethostname", "socket.getfqdn"):
            cls.enterClassContext(mock.patch(function, return_value=HOST))
        names = list(os.uname())
        names[1] = HOST
        cls.enterClassContext(mock.patch("os.uname", return_value=os.uname_result(names)))
        begins = [(step.name, world.waits, world.now_s) for step in cls.whole.steps()]
        begins.append(("", world.waits, world.now_s))
        cls.lasts = {
            name: (next_waits - waits, next_s - now_s)
            for (name, waits, now_s), (_name, next_waits, next_s) in pairwise(begins)
        }

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
        for seed in (47, 163, 9087):
            with self.subTest(seed=seed):
                contact, member = contact_with(self.library, seed)
                assert wrong(contact, member) == []

    def test_a_simulator_with_the_robot_file_is_that_robot(self) -> None:
        contact, member = self.whole, self.member
        simulated = self.library.of_robot_file(contact.session.known)
        for name, value, tolerance in (*member.answers(), *member.on_wheels()):
            if name in simulated:
                assert abs(simulated[name] - value) <= tolerance + 1e-6, name
        assert simulated["input_shift"] == member.t["input_shift"]
        assert abs(simulated["watchdog_cycles"] - member.t["watchdog_cycles"]) <= 5

    def test_interrupted_anywhere_in_any_step_it_goes_on_with_that_step(self) -> None:
        left = {
            name: [waits * 3 // 4, waits // 2, 1] if waits > 2 else []
            for name, (waits, _seconds) in self.lasts.items()
        }
        interruptions = sum(map(len, left.values()))
        config, drawn = self.library.member(DRIVEN)
        world = VirtualWorld(self.library, config, bool(drawn["other_status_port"]))
        contact, state, begun = Contact(world), "", ""
        interrupted = 0
        while len(contact.done) < len(STEPS):
            assert contact.refused is None
            try:
                for step in contact.steps():
                    begun = step.name
                    # The command keeps it so before each step: all that is left of a killed one.
                    state = json.dumps(contact.state())
                    world.interrupt_at_wait = world.waits + left[begun].pop() if left[begun] else -1
            except KeyboardInterrupt:
                interrupted += 1
                if interrupted % 2:
                    contact.session.leave()
                contact = Contact(world)
                contact.resume(json.loads(state))
                contact.rejoin()
                assert next(iter(contact.steps())).name == begun
        assert interrupted == interruptions, (interrupted, interruptions, left)
        found = wrong(contact, Member(drawn))
        assert found == [], found

    def test_nothing_moves_unless_the_key_is_held(self) -> None:
        contact = self.contact(DRIVEN)
        world = contact.session.world
        world.holds = False
        spoken = [step.name for step in contact.steps() if step.name == "stops"]
        assert spoken == ["stops"]
        assert "hold" in world.asked

    def test_each_step_that_moves_waits_for_the_key_to_be_pressed_anew(self) -> None:
        contact = self.contact(DRIVEN)
        world, s = contact.session.world, contact.session
        holds: list[float] = []
        hold = world.hold
        world.hold = lambda text: (holds.append(world.now_s), hold(text))
        begun = [(step, world.now_s) for step in contact.steps()]
        begun.append((STEPS[-1], math.inf))
        for (step, from_s), (_next, to_s) in pairwise(begun):
            driven = [at_s for at_s, v in commands(s) if any(v) and from_s <= at_s < to_s]
            pressed = [at_s for at_s in holds if from_s <= at_s < to_s]
            if step.moves:
                assert pressed[0] <= driven[0], step.name
            else:
                assert driven == [], step.name

    def test_a_key_that_is_still_held_does_not_count_as_pressed_anew(self) -> None:
        for reports_releases in (False, True):
            with self.subTest(reports_releases=reports_releases):
                self.hold_over(reports_releases)

    def hold_over(self, reports_releases: bool) -> None:
        """Hold the key since before the question, let it go for 0.5 s, and press it anew."""
        keyboard = mock.Mock(reports_releases=reports_releases)
        world = TerminalWorld("127.0.0.1", 9, keyboard)
        let_go_s = world.now_s + 1.5
        again_s = let_go_s + 0.5
        typed_s = 0.0

        def keys(_seconds: float) -> list[Key]:
            nonlocal typed_s
            now_s = world.now_s
            if let_go_s <= now_s < again_s:
                return [Key(" ", "release")] if reports_releases else []
            if now_s < typed_s + 0.03:
                return []
            typed_s = now_s
            return [Key(" ", "press")]

        keyboard.keys.side_effect = keys
        said: list[str] = []
        with mock.patch.object(TerminalWorld, "say", side_effect=said.append):
            world.hold("Hold it.")
        assert world.now_s >= again_s
        assert said == ["  Let the space bar go first.", "  Hold it."]

    def test_let_go_at_any_time_of_any_step_no_speed_is_sent_until_it_is_held_again(self) -> None:
        contact = self.contact(DRIVEN)
        world, s = contact.session.world, contact.session
        chance = random.Random(39)
        please, left, longest_s = world.please, 0, 0.0

        def let_go_once_more() -> None:
            nonlocal left
            left -= 1
            if left >= 0:
                world.let_go_at_s = world.now_s + chance.uniform(0.0, longest_s)

        def ask(key: str, text: str) -> None:
            please(key, text)
            if key == "again":
                world.holds = False
                world.hold("")
                let_go_once_more()

        world.please = ask
        for step in contact.steps():
            left, longest_s = 8 if step.moves else 0, self.lasts[step.name][1]
            world.let_go_at_s = math.inf
            let_go_once_more()
        assert contact.refused is None
        sent = commands(s)
        stopped = 0
        for let_go_s, again_s in world.let_go:
            before = [speeds for at_s, speeds in sent if at_s <= let_go_s]
            after = [(at_s, v) for at_s, v in sent if let_go_s < at_s <= again_s]
            assert not any(any(v) for _at_s, v in after)
            if before and any(before[-1]):
                stopped += 1
                assert after[0][0] - let_go_s < 0.03
                assert len(after) > 3
        assert stopped > 10, (stopped, len(world.let_go))

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

    def test_what_is_sent_to_the_project_has_no_address_no_name_and_no_date(self) -> None:
        contact = self.whole
        with tempfile.TemporaryDirectory(prefix="somebody") as folder:
            bundle.write(contact, Path(folder), "contact.pcapng", {})
            with zipfile.ZipFile(Path(folder) / "contact.zip") as archive:
                files = {info.filename: archive.read(info) for info in archive.infolist()}
                assert {info.date_time[0] for info in archive.infolist()} == {1980}
        assert files.keys() == {"contact.html", "contact.pcapng", "row.md"}
        private = (
            HOST,
            f"/{getpass.getuser()}",
            "somebody",
            str(date.today().year),
            "/home/",
        )
        for name, content in files.items():
            for text in private:
                assert text.encode() not in content, (name, text)
        heads = list(packets(files["contact.pcapng"]))
        assert len(heads) == len(contact.session.log)
        assert heads[0][0] == 0.0
        assert abs(heads[-1][0] - contact.session.world.now_s) < 60.0
        # IPv4 without a frame of Ethernet: no hardware address; 192.0.2.0/24 is nobody's.
        assert {head[:1] for _at_s, head in heads} == {b"\x45"}
        assert {head[12:15] for _at_s, head in heads} == {bytes([192, 0, 2])}
        assert {head[16:19] for _at_s, head in heads} == {bytes([192, 0, 2])}

    def test_the_page_draws_steps_watchdog_and_clock_and_what_people_did(self) -> None:
        contact = self.whole
        page = bundle.page(contact, {"another": contact.session.known | {"override_index": 9}})
        for title in ("Step of the forward speed", "After the last command", "The two clocks"):
            assert title in page
        assert page.count("<svg") == 4
        assert "another: override_index (8, not 9)" in page
        watched = dict(contact.session.watched)
        assert watched["Pressed the rear bumper."] == "digital inputs: 1 went on"
        sticks = next(saw for did, saw in watched.items() if did.startswith("Push the left stick"))
        assert sticks.startswith("analog 4 to +1.00, analog 4 to -1.00, analog 3 to -1.00")
        board = watched["A board 0.5 m in front of telemeter 1, which points to 180 degrees."]
        assert board.endswith("0.50 m then")
        outage = watched["The network cable was pulled while the wheels turned."]
        assert outage.startswith("Afterwards the wheels turned at 0.00 m/s")

    def test_each_answer_has_its_unit_and_says_what_it_is(self) -> None:
        modules = Path(bundle.__file__).parent.glob("*.py")
        source = "".join(path.read_text(encoding="utf-8") for path in modules)
        names = {*re.findall(r'learn\("(\w+)"', source), *self.whole.session.known}
        assert len(names) > 60
        units = {"ms": "ms", "m_s": "m/s", "rad_s": "rad/s", "m_s2": "m/s²", "rad_s2": "rad/s²"}
        units |= {"cycles": "cycles of 10 ms", "m": "m", "rad": "rad", "ppm": "ppm"}
        for name in names:
            phrase, unit = answers.MEANINGS[name]
            assert phrase, name
            ends = [end for end in units if name.endswith(f"_{end}")]
            assert not ends or unit == units[max(ends, key=len)], name
        said = [text for *_when, text in self.whole.session.world.said]
        watchdog_ms = self.whole.session.known["robot_watchdog_ms"]
        meant = "after this long without commands the robot stops itself"
        assert f"  robot_watchdog_ms = {watchdog_ms:g} ms: {meant}" in said
        page = bundle.page(self.whole, {})
        assert f'<td class="text">{meant}</td><td>{watchdog_ms:g} ms</td>' in page

    def test_the_simulator_is_in_the_table_of_known_robots(self) -> None:
        contact = Contact(VirtualWorld(self.library, self.library.usual(), other_port=False))
        for _step in contact.steps():
            pass
        file = Path(bundle.__file__).parent / "known" / "simulator.txt"
        lines = [line.split(" = ") for line in file.read_text().splitlines() if " = " in line]
        known = {name: float(value) for name, value in lines}
        assert known.keys() == contact.session.known.keys()
        assert bundle.differing(known, contact.session.known) == []
        page = Path(__file__).parents[3] / "docs" / "first-contact.md"
        row = bundle.row(contact.session.known, "the simulator's defaults (simulated)")
        assert row in page.read_text(encoding="utf-8").splitlines()

    def test_wheels_that_turn_the_wrong_way_are_not_driven(self) -> None:
        for direction in ("backward", "right"):
            with self.subTest(direction=direction):
                contact = self.contact(DRIVEN)
                world = contact.session.world
                ask = world.ask
                world.ask = lambda key, text, ask=ask, wrong=direction: (
                    "no" if key == wrong else ask(key, text)
                )
                names = [step.name for step in contact.steps()]
                assert names[-1] == "stops"
                assert contact.refused is not None
                assert contact.refused.reason == "wrong_way"
                assert commands(contact.session)[-1][1] == (0.0, 0.0)

    def test_a_network_that_loses_datagrams_is_reported_and_another_sender_refused(self) -> None:
        contact = self.contact(DRIVEN)
        world = contact.session.world
        for step in contact.steps():
            if step.name == "network":
                world.loses = 0.2
            if step.name == "errors":
                break
        assert 5 < contact.session.notes["lost, of 100 requests"] < 60
        contact = self.contact(DRIVEN)
        world = contact.session.world
        world.other_sender = (0.1, 0.0)
        assert [step.name for step in contact.steps()] == ["directory", "network"]
        assert contact.refused is not None
        assert contact.refused.reason == "other_sender"

    def test_who_does_not_act_in_time_is_asked_again(self) -> None:
        for key, times in (
            ("release_pad_a", 1),
            ("cable_out", 1),
            ("press_pad_a", 2),
        ):
            with self.subTest(key=key, times=times):
                contact = self.contact(DRIVEN, pad_keeps_target=2, ignored_commands_feed=0)
                world = contact.session.world
                world.misses = {key: times}
                for _step in contact.steps():
                    pass
                known, again = contact.session.known, "missed"
                assert world.asked.count(again) == times
                assert known["pad_keeps_target"] == 2
                assert known["ignored_commands_feed"] == 0
                assert ["The network cable was to be pulled."] not in [
                    each[:1] for each in contact.session.watched
                ]

    def test_statuses_that_come_seconds_late_are_not_called_refused(self) -> None:
        for service, mask in (("iocard", 4), ("differential", 64)):
            with self.subTest(service=service):
                contact = self.contact(DRIVEN, **{f"queue_{service}_ms": 4000})
                for step in contact.steps():
                    if step.name == "inputs":
                        break
                assert int(contact.session.known["refused_inserts"]) & mask == 0
                assert abs(contact.session.known[f"queue_{service}_ms"] - 4000) < 60

    def test_statuses_that_do_not_come_are_not_called_refused(self) -> None:
        contact = self.contact(DRIVEN)
        contact.session.world.loses_statuses = True
        for _step in contact.steps():
            pass
        assert contact.refused is not None
        assert contact.refused.reason == "no_statuses"
        assert "refused_inserts" not in contact.session.known

    def test_what_was_done_in_a_step_before_the_key_was_let_go_is_not_repeated(self) -> None:
        for name, key in (("stops", "lift"), ("power on", "restart")):
            with self.subTest(step=name):
                contact = self.contact(DRIVEN)
                world = contact.session.world
                for step in contact.steps():
                    if name in contact.done:
                        break
                    if step.name == name:
                        self.let_go_once(world)
                        begun = len(world.asked)
                assert world.asked[begun:].count("again") == 1
                assert world.asked[begun:].count(key) == 1

    @staticmethod
    def let_go_once(world: VirtualWorld) -> None:
        """Let the key go soon after it is held next."""
        hold = world.hold

        def hold_shortly(text: str) -> None:
            world.hold = hold
            hold(text)
            world.let_go_at_s = world.now_s + 0.3

        world.hold = hold_shortly

    def test_a_countdown_that_something_else_overtakes_is_not_counted_on(self) -> None:
        keyboard = mock.Mock(reports_releases=False)
        world = TerminalWorld("127.0.0.1", 9, keyboard)
        typed_s = world.now_s + 2.0
        keyboard.keys.side_effect = lambda _s: [Key("\n", "press")] if world.now_s > typed_s else []
        said: list[str] = []
        with mock.patch.object(TerminalWorld, "say", side_effect=said.append):
            world.countdown("cable_out", "Pull it at 0.", 1.0)
            world.please("again", "Get ready.")
        assert said == ["  Pull it at 0.", "  Get ready. Then press Enter."]

    def test_a_response_that_is_over_within_a_cycle_is_immediate(self) -> None:
        noise = random.Random(5)
        for omega, noise_m_s, found in ((1000, 0.0, 1000), (700, 0.0, 1000), (1000, 0.02, 1000)):
            speeds = simulate(Response(omega, 1.0, 1.0, 2, 0.0), [0.36] * 200, (-9e3, 9e3))
            heard = [v + noise.uniform(-noise_m_s, noise_m_s) for v in [0.0] * 3 + speeds]
            heard[:3] = [0.0] * 3
            response = fit(0.36, heard, (-9e3, 9e3))
            assert response is not None
            assert response.omega_rad_s == found, (omega, noise_m_s, response)
        speeds = simulate(Response(250, 1.0, 1.0, 2, 0.0), [0.36] * 200, (-9e3, 9e3))
        response = fit(0.36, [0.0] * 3 + speeds, (-9e3, 9e3))
        assert response is not None
        assert abs(response.omega_rad_s - 250) < 25

    def test_what_is_missing_is_said_at_once_and_what_that_means(self) -> None:
        for step, changes, text in (
            ("network", {"hidden_services": 4}, "The robot has no iocard: nobody would see"),
            ("network", {"digital_inputs": 0}, "The iocard has no digital inputs: nobody"),
            ("inputs", {"refused_inserts": 32}, "The robot does not report its localization"),
        ):
            with self.subTest(text=text):
                contact = self.contact(DRIVEN, **changes)
                assert step in [each.name for each in islice(contact.steps(), 6)]
                assert any(text in said for *_when, said in contact.session.world.said)

    def test_a_robot_that_endangers_is_refused_with_the_reason(self) -> None:
        late_targets = {"dead_time_cycles": 15, "late_targets": 1, "queue_differential_ms": 400}
        for change, reason, is_still in (
            ({"hidden_services": 64}, "no_differential", True),
            ({"digital_inputs": 5}, "no_game_pad", True),
            ({"refused_inserts": 4}, "no_inputs", True),
            ({"max_subscriptions": 1}, "list_full", True),
            ({"queue_iocard_ms": 670}, "late", True),
            ({"queue_uplink_ms": 400, "queue_differential_ms": 300}, "late", True),
            (late_targets, "late", False),
            ({"watchdog_cycles": 3000}, "slow_watchdog", False),
            ({"hidden_services": 32}, "no_localization", False),
            ({"odometry_mirrored": 1}, "odometry", False),
        ):
            with self.subTest(reason=reason):
                contact = self.contact(DRIVEN, **change)
                moved = [step.name for step in contact.steps() if step.moves]
                assert contact.refused is not None
                assert contact.refused.reason == reason
                assert is_still == (moved == [])


if __name__ == "__main__":
    unittest.main()
