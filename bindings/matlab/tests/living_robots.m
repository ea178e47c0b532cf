function count = living_robots()
%LIVING_ROBOTS How many robots the MEX file has.
%
%   Example:
%      check(living_robots() == 0, 'a robot was left')

% SPDX-License-Identifier: MIT
living = roburoc4.internal.roburoc4_mex('living');
count = living.robots;
end
