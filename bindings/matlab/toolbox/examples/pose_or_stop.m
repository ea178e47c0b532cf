function pose = pose_or_stop(robot, loop, longest_s)
%POSE_OR_STOP Return the pose if it is safe to keep driving; else stop and raise an error.
%   POSE = pose_or_stop(ROBOT, LOOP, LONGEST_S) raises roburoc4:timeout when the pose is older than
%   fresh_ms, or when LOOP has lasted longer than LONGEST_S.
%
%   Example:
%      loop = robot.rate(20);
%      while true
%          pose = pose_or_stop(robot, loop, 60);
%          robot.drive(0.3, -pose(3));
%          loop.wait();
%      end
%
%   See also roburoc4.Robot, roburoc4.Rate.

% SPDX-License-Identifier: MIT
pose = robot.pose;
if any(isnan(pose))
    robot.stop();
    error('roburoc4:timeout', ['the pose is old. Check link, and the period of the ' ...
        'localization''s statuses']);
elseif loop.time_s > longest_s
    robot.stop();
    error('roburoc4:timeout', 'the path was not finished after %g s. Is the robot too slow, or blocked?', longest_s);
end
end
