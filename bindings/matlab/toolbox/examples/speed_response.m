function fit = speed_response(robot, picture, step_m_s)
%SPEED_RESPONSE Identify the response of the linear speed: step, fit, plot.
%   FIT = speed_response(ROBOT) drives ahead at 0.5 m/s for four seconds with a roburoc4.Robot, which
%   NEEDS 3 M OF FREE SPACE, and fits a model of second order with unit gain to the speed:
%   FIT.natural_rad_s (omega_n), FIT.damping (zeta), FIT.delay_s, FIT.rms_m_s. Without a robot it
%   makes a simulated one. speed_response(ROBOT, PICTURE, STEP_M_S) writes the plot to a PNG file and
%   drives at another speed: IT NEEDS ABOUT 6 x STEP_M_S METRES.
%
%   It gives up and stops when the robot does not move or the pose is old.
%
%   Connect with 'differential_period_ms', 10 for a sample in each cycle of the robot.
%
%   Example:
%      r = roburoc4.Robot('192.168.0.2', 'differential_period_ms', 10);
%      fit = speed_response(r)
%
%   See also fminsearch, pose_or_stop.

% SPDX-License-Identifier: MIT
if nargin < 1 || isempty(robot)
    sim = roburoc4.Simulator();
    robot = sim.connect('differential_period_ms', 10);
end
if nargin < 3
    step_m_s = 0.5;
end

robot.arm();
robot.driveFor(0, 0, 0.5);
robot.log();                             % the next log starts here
loop = robot.rate(20);
while loop.time_s < 4
    pose_or_stop(robot, loop, 5);
    robot.drive(step_m_s, 0);
    loop.wait();
end
robot.pause();
data = robot.log('', roburoc4.Service.DIFFERENTIAL);

% The robot's own clock is free of the network's jitter. Zero is the first status with the target.
speed = data.differential;
time_s = double(speed.robot_cycles) * roburoc4.Service.CYCLE_S;
begun = find(speed.target_linear_m_s > 0, 1);
last = find(speed.target_linear_m_s > 0, 1, 'last');
time_s = time_s(begun:last) - time_s(begun);
measured = speed.current_linear_m_s(begun:last);

% Logarithms keep the two parameters positive.
cost = @(p) sum((model(exp(p(1)), exp(p(2)), p(3), step_m_s, time_s) - measured) .^ 2);
found = fminsearch(cost, [log(2), log(0.7), 0], optimset('TolX', 1e-6, 'TolFun', 1e-10));
fit.natural_rad_s = exp(found(1));
fit.damping = exp(found(2));
fit.delay_s = found(3);
fit.rms_m_s = sqrt(cost(found) / numel(measured));

shown = canvas(nargin < 2, 800, 600);
plot(time_s, measured, '.', 'Color', [0.6 0.6 0.6], 'MarkerSize', 14);
hold on
plot(time_s, model(fit.natural_rad_s, fit.damping, fit.delay_s, step_m_s, time_s), 'r');
grid on; xlabel('time, s'); ylabel('linear speed, m/s');
title(sprintf('Speed response: \\omega_n = %.2f rad/s, \\zeta = %.2f', fit.natural_rad_s, ...
    fit.damping));
legend({'measured', 'model'}, 'Location', 'southeast');
if nargin > 1
    print(shown, picture, '-dpng', '-r100');
    close(shown);
end
end

function y = model(natural, damping, delay_s, step, time_s)
% Step response of natural^2 / (s^2 + 2 damping natural s + natural^2), at any damping.
t = max(0, time_s - delay_s);
root = natural * sqrt(complex(damping ^ 2 - 1));
root = root + (abs(root) < 1e-9) * 1e-9;
decay = exp(-damping * natural * t);
y = step * real(1 - decay .* (cosh(root * t) + damping * natural / root * sinh(root * t)));
end
