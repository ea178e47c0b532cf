# SPDX-License-Identifier: MIT
"""What is both in the C headers and in the package is the same."""

import ast
import re
from pathlib import Path

import pytest
from robot_support import header

import roburoc4
from roburoc4 import _native, constants

FAMILIES = {
    "SERVICE": (constants.Service, {"COUNT"}),
    "ACTION": (constants.Action, set()),
    "ERROR": (constants.WireError, set()),
    "BATTERY": (constants.BatteryState, set()),
    "LOCALIZATION": (constants.LocalizationFlag, set()),
    "IO": (constants.IoType, set()),
    "STATE": (constants.State, set()),
    "STOP": (constants.StopOutcome, set()),
    "ROLE": (constants.Role, {"COUNT"}),
    "EVENT": (constants.Event, set()),
    "COUNT": (constants.Count, set()),
    "ERR": (constants.Result, set()),
    "MOVE": (constants.MoveOutcome, set()),
    "FAULT": (constants.Fault, set()),
}

HEADERS = header() + header("roburoc4_move.h") + header("roburoc4_udp.h")


def defined(text: str, family: str) -> dict[str, int]:
    found = re.findall(rf"#define ROBUROC4_{family}_(\w+)\s[\s\\]*\(?(-?\w+)\)?", text)
    return {name: int(value, 0) for name, value in found}


@pytest.mark.parametrize("family", FAMILIES)
def test_enumerations_are_those_of_the_header(family: str) -> None:
    enumeration, left_out = FAMILIES[family]
    expected = {n: v for n, v in defined(HEADERS, family).items() if n not in left_out}
    mine = {name: int(member) for name, member in enumeration.__members__.items()}
    if enumeration is constants.Result:
        mine.pop("OK")
    assert mine == expected


def test_options_are_those_of_the_header() -> None:
    from roburoc4 import settings

    expected = {n.lower(): v for n, v in defined(header(), "OPTION").items()}
    assert expected == settings._OPTIONS


def test_versions_and_addresses_are_those_of_the_header() -> None:
    text = header()
    parts = [re.search(rf"VERSION_{part} (\d+)", text) for part in ("MAJOR", "MINOR", "PATCH")]
    assert roburoc4.__version__ == ".".join(part[1] for part in parts if part)
    assert f'HOST "{roburoc4.protocol.DEFAULT_HOST}"' in text
    assert f"PORT {roburoc4.protocol.DEFAULT_PORT}" in text


def test_every_result_becomes_an_exception_with_its_code() -> None:
    for result in constants.Result:
        if result is constants.Result.OK:
            continue
        error = roburoc4.errors.error_of(result)
        assert isinstance(error, roburoc4.RobotError)
        assert error.code == result
        assert str(error)
    assert isinstance(roburoc4.errors.error_of(constants.Result.TIMEOUT), TimeoutError)


def test_every_reason_against_driving_has_a_remedy() -> None:
    for result in constants.Result:
        refuses = constants.Result.SUBSCRIPTION_REFUSED <= result <= constants.Result.DISARMED
        if refuses and result is not constants.Result.UNITS:
            error = roburoc4.errors.error_of(result)
            assert isinstance(error, roburoc4.NotArmedError)
            assert "None" not in str(error)
            assert re.fullmatch("not armed[:;] [^:]+(; .+)?", str(error))
            assert re.search(r"; |arm\(\)", str(error))


def test_the_stubs_name_functions_that_exist() -> None:
    stub = Path(roburoc4.__file__).with_name("_native.pyi").read_text(encoding="utf-8")
    functions = [n.name for n in ast.walk(ast.parse(stub)) if isinstance(n, ast.FunctionDef)]
    assert len(functions) > 80
    assert [name for name in functions if not hasattr(_native, name)] == []
