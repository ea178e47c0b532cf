classdef Resume
%RESUME After what a robot may be armed again by itself: the option resume, a sum of these.
%   Nothing by default. See docs/SAFETY.md before you use it.
%
%   Example:
%      r = roburoc4.Robot('192.168.0.2', 'resume', roburoc4.Resume.OVERRIDE);
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
properties (Constant)
    OVERRIDE = 1
    LOSS = 2
    REBOOT = 4
end
end
