function count = living_robots()
%LIVING_ROBOTS Count the robots of the MEX file.
%
%   Example:
%      check(living_robots() == 0, 'a robot was left')

% SPDX-License-Identifier: MIT
living = roburoc4_mex('living');
count = living.robots;
end
