# SPDX-License-Identifier: MIT
"""Only a stall that was measured excuses a failure, and only a long one that of the last try."""

from unittest.mock import Mock

import pytest
import strain


@pytest.mark.parametrize("failure", [AssertionError("wrong"), pytest.fail.Exception("not raised")])
@pytest.mark.parametrize(
    ("tried", "worst_s", "ended"),
    [
        (1, 0.0, None),
        (1, 0.1, strain.MachineTooBusyError),
        (3, 0.1, strain.MachineTooBusyError),
        (3, 0.3, pytest.skip.Exception),
    ],
)
def test_a_failure_is_excused_by_a_stall_alone(
    monkeypatch: pytest.MonkeyPatch,
    failure: BaseException,
    tried: int,
    worst_s: float,
    ended: type[BaseException] | None,
) -> None:
    monkeypatch.setattr(strain, "worst_s", lambda: worst_s)
    judged = strain.explained(Mock(execution_count=tried))
    next(judged)
    with pytest.raises(ended or type(failure)):
        judged.throw(failure)
