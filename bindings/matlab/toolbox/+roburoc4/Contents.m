% roburoc4: drive, watch and simulate a RobuROC4 mobile robot
%
% Objects
%   Robot            - A RobuROC4: drive it, read it, record it
%   Simulator        - A simulated RobuROC4, to try out programs without a robot
%   Rate             - A control loop with a fixed rate, without a timer
%   System           - A RobuROC4 as a block of Simulink (not in Octave)
%
% Functions
%   asTimetable      - Make a timetable of one service's columns
%
% Constants
%   BatteryState     - States of the battery
%   LocalizationFlag - Bits of the localization's state
%   Result           - Why a robot is not armed
%   Service          - Names of the services that send statuses
%
% Example:
%    r = roburoc4.Robot('192.168.0.2');
%    r.arm();
%    r.driveFor(0.3, 0, 2);
%    data = r.record(1); plot(data.telemeter.time_s, data.telemeter.distances_m)
%    delete(r)

% SPDX-License-Identifier: MIT
