classdef BatteryState
%BATTERYSTATE States of the battery (manual 4.2.4.6), as in status.battery_state.
%   It is NOT_KNOWN, 255, before the first status.
%
%   Example:
%      r.status.battery_state == roburoc4.BatteryState.CRITICAL
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
properties (Constant)
    CHARGING = uint8(0)
    CHARGED = uint8(1)
    OK = uint8(2)
    CRITICAL = uint8(3)
    NOT_KNOWN = uint8(255)
end
end
