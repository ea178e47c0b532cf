classdef Service
%SERVICE Names of the services that send statuses, and one robot cycle in seconds.
%
%   Example:
%      data = r.record(1, roburoc4.Service.LOCALIZATION);
%      robot_s = double(data.localization.robot_cycles) * roburoc4.Service.CYCLE_S;
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
properties (Constant)
    IOCARD = 'iocard'
    TELEMETER = 'telemeter'
    BATTERY = 'battery'
    LOCALIZATION = 'localization'
    DIFFERENTIAL = 'differential'
    CYCLE_S = 0.01
end
end
