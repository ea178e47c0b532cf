function track = drive_square(robot, picture, side_m)
%DRIVE_SQUARE Drive a square by odometry, and draw the path while driving.
%   TRACK = drive_square(ROBOT) drives a square of 1.5 m with a roburoc4.Robot: IT NEEDS FREE SPACE.
%   Without a robot it takes a simulated one. drive_square(ROBOT, PICTURE, SIDE_M) writes the plot to
%   a PNG file instead of a window. TRACK has the poses, [x_m y_m theta_rad] by row, seen from the
%   start.
%
%   The odometry of this robot is far off after turns: on the floor the square does not close. It
%   gives up, and disarms, when the motors are inhibited, the pose is old, or after 30 s and a minute
%   for each metre of SIDE_M.
%
%   Example:
%      drive_square(roburoc4.Robot('192.168.0.2', 'max_linear_m_s', 0.4))
%
%   See also roburoc4.Rate, pose_or_stop.

% SPDX-License-Identifier: MIT
if nargin < 1 || isempty(robot)
    sim = roburoc4.Simulator();
    sim.clearObstacles();
    robot = sim.connect();
end
if nargin < 3
    side_m = 1.5;
end
longest_s = 30 + 60 * side_m;
live = nargin < 2;
shown = canvas(live, 800, 600);
closed = onCleanup(@() leave(shown, live)); %#ok<NASGU>
way = plot([0 0], [0 0], 'b-');
axis([-0.4 1.4 -0.4 1.4] * side_m, 'equal');
grid on; xlabel('x, m'); ylabel('y, m'); title('A square, by odometry');

robot.arm();
loop = robot.rate(20);
robot.spin(0.2);
start = pose_or_stop(robot, loop, longest_s);
track = [0 0 0];                         % seen from the start
for corner = 1:4
    heading_rad = (corner - 1) * pi / 2;
    from = track(end, :);
    % Ahead, keeping the heading, and slower towards the end.
    left_m = side_m;
    while left_m > 0.02
        pose = seen_from(start, pose_or_stop(robot, loop, longest_s));
        left_m = side_m - [cos(heading_rad) sin(heading_rad)] * (pose(1:2) - from(1:2))';
        v = min(0.5, 0.5 * left_m);
        robot.drive(max(v, 0.03), 1.5 * wrapped(heading_rad - pose(3)));
        loop.wait();
        track = drawn(track, pose, way, live);
    end
    % Turn left by 90 degrees, until the robot stands in the new heading.
    turned = false;
    while ~turned
        pose = seen_from(start, pose_or_stop(robot, loop, longest_s));
        speeds = robot.speeds;
        error_rad = wrapped(heading_rad + pi / 2 - pose(3));
        robot.drive(0, max(-0.8, min(0.8, 1.2 * error_rad)));
        turned = abs(error_rad) < 0.02 && abs(speeds(2)) < 0.05;
        loop.wait();
        track = drawn(track, pose, way, live);
    end
end
robot.stop();
set(way, 'XData', track(:, 1), 'YData', track(:, 2));
if ~live
    print(shown, picture, '-dpng', '-r100');
end
if nargout == 0
    clear track;                            % or Octave would print hundreds of rows
end
end

function leave(shown, live)
% A figure that is not shown is closed, however this ends.
if ~live
    close(shown);
end
end

function track = drawn(track, pose, way, live)
track(end + 1, :) = pose;
if live && mod(size(track, 1), 5) == 0
    set(way, 'XData', track(:, 1), 'YData', track(:, 2));
    drawnow();
end
end

function pose = seen_from(start, pose)
turn = [cos(start(3)), -sin(start(3)); sin(start(3)), cos(start(3))];
pose = [(pose(1:2) - start(1:2)) * turn, wrapped(pose(3) - start(3))];
end

function angle_rad = wrapped(angle_rad)
angle_rad = atan2(sin(angle_rad), cos(angle_rad));
end
