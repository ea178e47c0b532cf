classdef LocalizationFlag
%LOCALIZATIONFLAG Bits of status.localization_flags (manual 4.2.4.7).
%
%   Example:
%      bitand(r.status.localization_flags, roburoc4.LocalizationFlag.INVALID) ~= 0
%
%   See also roburoc4.Robot, bitand.

% SPDX-License-Identifier: MIT
properties (Constant)
    INVALID = uint8(1)
    METRIC = uint8(2)
    DECIMETRIC = uint8(4)
    CENTIMETRIC = uint8(8)
    PROPRIOCEPTIVE = uint8(16)
    EXTEROCEPTIVE = uint8(32)
    ERROR = uint8(64)
end
end
