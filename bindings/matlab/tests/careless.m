function careless(address)
%CARELESS Drive with a lease of a second, and fail.
%   The error takes the robot object with it.
%
%   Example:
%      try, careless(sim.address), catch, end

% SPDX-License-Identifier: MIT
r = roburoc4.Robot(address, 'lease_ms', 1000);
r.arm(10);
r.drive(0.3, 0);
r.sleep(0.02);
r.drive(0.3, 0);
error('roburoc4:check', 'a user''s mistake');
end
