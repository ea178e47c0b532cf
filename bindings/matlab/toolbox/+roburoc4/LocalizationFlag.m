classdef LocalizationFlag
%LOCALIZATIONFLAG Bits of status.localization_flags (manual 4.2.4.7).
%
%   Example:
%      bitand(r.status.localization_flags, roburoc4.LocalizationFlag.INVALID) ~= 0
%
%   See also roburoc4.Robot, bitand.

% SPDX-License-Identifier: MIT
properties (Constant)
    INVALID = 1
    METRIC = 2
    DECIMETRIC = 4
    CENTIMETRIC = 8
    PROPRIOCEPTIVE = 16
    EXTEROCEPTIVE = 32
    ERROR = 64
end
end
