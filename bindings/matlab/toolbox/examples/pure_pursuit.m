function [track, path] = pure_pursuit(robot, picture)
%PURE_PURSUIT Follow a path with the pure pursuit law.
%   [TRACK, PATH] = pure_pursuit(ROBOT) follows a wave of 6 m with a roburoc4.Robot: IT NEEDS FREE
%   SPACE of 7 m by 3 m. Without a robot it makes a simulated one. TRACK has the poses of the
%   odometry by row, PATH the points of the path. pure_pursuit(ROBOT, PICTURE) writes the plot to a
%   PNG file.
%
%   Twenty times a second: find the point of the path that is LOOK_M ahead, and take the curve that
%   leads to it, omega = 2 v sin(alpha) / LOOK_M. The speed response lags behind by more than half
%   a second, so the speed is low and LOOK_M is long. It gives up and stops when the robot
%   does not move, the pose is old, or after a minute.
%
%   Example:
%      pure_pursuit(roburoc4.Robot('192.168.0.2', 'max_linear_m_s', 0.5))
%
%   See also roburoc4.Rate, pose_or_stop.

% SPDX-License-Identifier: MIT
if nargin < 1 || isempty(robot)
    sim = roburoc4.Simulator();
    sim.clearObstacles();
    robot = sim.connect();
end
look_m = 0.6;
speed_m_s = 0.4;
longest_s = 60;

robot.arm();
loop = robot.rate(20);
robot.sleep(0.2);
start = pose_or_stop(robot, loop, longest_s);
along = (0:0.02:6)';
wave = [along, 0.6 * sin(2 * pi * along / 4) .* min(1, along)];
turn = [cos(start(3)), sin(start(3)); -sin(start(3)), cos(start(3))];
path = wave * turn + repmat(start(1:2), numel(along), 1);

track = start;
nearest = 1;
while norm(path(end, :) - track(end, 1:2)) > 0.1
    pose = pose_or_stop(robot, loop, longest_s);
    distance_m = sqrt(sum((path - repmat(pose(1:2), size(path, 1), 1)) .^ 2, 2));
    % Only forward along the path: a path may cross itself.
    window = nearest:min(nearest + 50, numel(distance_m));
    [~, best] = min(distance_m(window));
    nearest = window(best);
    ahead = nearest - 1 + find(distance_m(nearest:end) >= look_m, 1);
    if isempty(ahead)
        ahead = size(path, 1);
    end
    toward = path(ahead, :) - pose(1:2);
    alpha = atan2(toward(2), toward(1)) - pose(3);
    remaining_m = norm(path(end, :) - pose(1:2));
    v = min(speed_m_s, 0.15 + 0.5 * remaining_m);
    robot.drive(v, 2 * v * sin(alpha) / max(norm(toward), 0.3));
    loop.wait();
    track(end + 1, :) = pose; %#ok<AGROW>
end
robot.pause();

shown = canvas(nargin < 2, 800, 600);
plot(path(:, 1), path(:, 2), 'Color', [0.6 0.6 0.6]);
hold on
plot(track(:, 1), track(:, 2), 'b');
axis equal; grid on; xlabel('x, m'); ylabel('y, m'); title('Pure pursuit of a path, by odometry');
legend({'path', 'robot'}, 'Location', 'southeast');
if nargin > 1
    print(shown, picture, '-dpng', '-r100');
    close(shown);
end
if nargout == 0
    clear track;                            % or Octave would print hundreds of rows
end
end
