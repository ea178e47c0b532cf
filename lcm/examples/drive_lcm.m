% SPDX-License-Identifier: MIT
%
% Drive a gentle curve for three seconds through roburoc4-lcm, and plot the path by odometry.
%
% In MATLAB or GNU Octave, through LCM's Java interface. First, once:
%
%   javaaddpath('/path/to/lcm.jar')                  % from LCM; PyPI's wheel has it in share/java
%   javaaddpath('/path/to/lcmtypes_roburoc4.jar')    % from roburoc4, in share/java
%
% and, unless LCM's default is right, LCM_DEFAULT_URL in the shell that starts MATLAB.

network = javaMethod('getSingleton', 'lcm.lcm.LCM');
poses = javaObject('lcm.lcm.MessageAggregator');
poses.setMaxMessages(1000);
network.subscribe('ROBUROC4_LOCALIZATION', poses);

command = javaObject('roburoc4_lcm.drive_command_t');
% A unique name: two programs with the same name would both drive.
id = javaMethod('randomUUID', 'java.util.UUID');
command.sender = ['drive_lcm.m ', char(id.toString())];
command.linear_m_s = 0.3;
command.angular_rad_s = 0.2;

for step = 1:60
    % The bridge rejects old commands. A command's lease is 250 ms; after the last one the robot
    % stops.
    command.utime = javaMethod('currentTimeMillis', 'java.lang.System') * 1000;
    network.publish('ROBUROC4_DRIVE_CMD', command);
    pause(0.05);
end

way = zeros(0, 2);
message = poses.getNextMessage(1000);
while ~isempty(message)
    pose = javaObject('roburoc4_lcm.localization_status_t', message.data);
    way(end + 1, :) = [pose.x_m, pose.y_m]; %#ok<SAGROW>
    message = poses.getNextMessage(0);
end
if isempty(way)
    error('roburoc4:lcm', 'no pose arrived: is roburoc4-lcm running, on this LCM network?');
end
if max(abs(way(end, :) - way(1, :))) < 0.01
    error('roburoc4:lcm', ['the robot did not move: the log of roburoc4-lcm says why. If it says ' ...
        'nothing, it hears no command: LCM_DEFAULT_URL needs its ttl here, too']);
end
fprintf('%d poses, from %.2f %.2f to %.2f %.2f\n', size(way, 1), way(1, :), way(end, :));
if usejava('awt') || ~exist('OCTAVE_VERSION', 'builtin')
    plot(way(:, 1), way(:, 2)), axis equal, xlabel('x (m)'), ylabel('y (m)')
end
