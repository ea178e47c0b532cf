function track = drive_square(robot, picture, side_m)
%DRIVE_SQUARE Drive a square of four moves and four turns, and draw the path.
%   TRACK = drive_square(ROBOT) drives a square of 1.5 m with a roburoc4.Robot: IT NEEDS FREE SPACE.
%   Without a robot it takes a simulated one. drive_square(ROBOT, PICTURE, SIDE_M) writes the plot to
%   a PNG file instead of a window. TRACK has the poses, [x_m y_m theta_rad] by row, of the odometry.
%
%   The odometry of this robot is far off after turns: on the floor the square does not close. A move
%   that cannot reach its goal raises roburoc4:moveEnded, and the robot stops.
%
%   Example:
%      drive_square(roburoc4.Robot('192.168.0.2', 'max_linear_m_s', 0.4))
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
if nargin < 1 || isempty(robot)
    sim = roburoc4.Simulator();
    sim.clearObstacles();
    robot = sim.connect();
end
if nargin < 3
    side_m = 1.5;
end

robot.log();                              % the log of the path starts here
robot.arm();
for side = 1:4
    robot.move(side_m, 'speed', 0.5);
    robot.turn(pi / 2);
end
data = robot.log('', 'localization');
track = [data.localization.x_m, data.localization.y_m, data.localization.theta_rad];

shown = canvas(nargin < 2, 800, 600);
plot(track(:, 1), track(:, 2), 'b-');
axis([-0.4 1.4 -0.4 1.4] * side_m, 'equal');
grid on; xlabel('x, m'); ylabel('y, m'); title('A square, by odometry');
if nargin > 1
    print(shown, picture, '-dpng', '-r100');
    close(shown);
end
if nargout == 0
    clear track;                            % or Octave would print hundreds of rows
end
end
