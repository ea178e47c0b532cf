classdef Result
%RESULT Why a robot is not armed, as in status.disarm_cause: ROBUROC4_ERR_* of roburoc4.h.
%   status.disarm_text is the same as a sentence, with what to do.
%
%   Example:
%      r.status.disarm_cause == roburoc4.Result.OVERRIDE
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
properties (Constant)
    OK = 0
    DISARMED = -20
    NOT_READY = -21
    NO_DIFFERENTIAL = -22
    LIMITS = -23
    STALE_DIFFERENTIAL = -24
    STALE_IOCARD = -25
    OVERRIDE_UNKNOWN = -26
    OVERRIDE = -27
    MOVING = -28
    OTHER_COMMANDER = -29
    LOST = -30
    REBOOT = -31
    CLOCK = -32
    INHIBITED = -33
    STOP_CALLED = -34
    LAPSED = -35
    UPLINK = -36
    UNITS = -37
    SUBSCRIPTION_REFUSED = -38
    CLOSED = -42
end
end
