function data = read_and_plot(robot, picture)
%READ_AND_PLOT Record five seconds of a robot and plot them.
%   DATA = read_and_plot(ROBOT) takes a roburoc4.Robot and never moves it. Without one it makes a
%   simulated robot that is driven with its game pad. read_and_plot(ROBOT, PICTURE) writes the
%   plot to a PNG file.
%
%   Example:
%      read_and_plot(roburoc4.Robot('192.168.0.2'))
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
if nargin < 1 || isempty(robot)
    sim = roburoc4.Simulator();
    robot = sim.connect();
    sim.set('pad_a', true);
    sim.set('pad_rt', -0.6);
    sim.set('pad_lj_x', -0.1);
end

data = robot.record(5);
channels = robot.inputs();
voltage = strcmpi(channels.analog_input_names, 'Battery voltage');

shown = canvas(nargin < 2, 900, 700);
subplot(2, 2, 1);
plot(data.localization.x_m, data.localization.y_m, 'b');
axis equal; grid on; xlabel('x, m'); ylabel('y, m'); title('Odometry');
subplot(2, 2, 2);
plot(data.differential.time_s, data.differential.current_linear_m_s, 'b', ...
    data.differential.time_s, data.differential.current_angular_rad_s, 'r');
grid on; xlabel('time, s'); title('Speeds');
legend({'linear, m/s', 'angular, rad/s'}, 'Location', 'southeast');
subplot(2, 2, 3);
plot(data.telemeter.time_s, data.telemeter.distances_m);
ylim([0 6.5]); grid on; xlabel('time, s'); ylabel('m'); title('Telemeters');
legend({'front', 'rear'}, 'Location', 'southeast');
subplot(2, 2, 4);
plot(data.iocard.time_s, data.iocard.analog_inputs(:, voltage));
grid on; xlabel('time, s'); ylabel('V'); title('Battery voltage');
if nargin > 1
    print(shown, picture, '-dpng', '-r100');
    close(shown);
end
if nargout == 0
    clear data;                            % or Octave would print hundreds of rows
end
end
