function sleep(id, seconds)
%SLEEP Wait with a robot, in slices short enough for Ctrl-C.
%   roburoc4.internal.sleep(ID, SECONDS) takes the id and not the object, so that it does not keep the
%   object from being deleted: clearing the object stops the robot.
%
%   Example:
%      roburoc4.internal.sleep(id, 0.2)
%
%   See also roburoc4.Robot, roburoc4.Rate.

% SPDX-License-Identifier: MIT
cleanup = roburoc4.internal.guard(id); %#ok<NASGU>
finish_s = roburoc4_mex('now', id) + seconds;
left_s = seconds;
while left_s > 0
    left_s = finish_s - roburoc4_mex('wait', id, min(left_s, 0.05));
end
roburoc4_mex('busy', id, false);
end
