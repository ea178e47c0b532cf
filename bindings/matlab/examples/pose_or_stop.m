function pose = pose_or_stop(robot, loop, longest_s)
%POSE_OR_STOP The pose, where the robot may be driven on; else disarm it, and say why.
%   POSE = pose_or_stop(ROBOT, LOOP, LONGEST_S) raises roburoc4:notArmed when the motors are
%   inhibited: a robot that goes on being told to drive moves the moment somebody lets go of the
%   emergency stop. It raises roburoc4:timeout when the pose is older than fresh_ms, or when LOOP has
%   lasted for longer than LONGEST_S.
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
if robot.status.inhibited
    robot.disarm();
    error('roburoc4:notArmed', ['the robot was told to drive, but stands still: look at emergency ' ...
        'stops, brakes and bumpers, then begin anew']);
elseif any(isnan(pose))
    robot.disarm();
    error('roburoc4:timeout', ['there is no pose that is fresh: look at link, and at the period ' ...
        'of the localization''s statuses']);
elseif loop.time_s > longest_s
    robot.disarm();
    error('roburoc4:timeout', 'not there after %g s: is the robot too slow, or held?', longest_s);
end
end
