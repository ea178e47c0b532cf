function pid = child(address, options, code)
%CHILD Start another Octave that drives a robot.
%   PID = child(ADDRESS, OPTIONS, CODE) starts a program that connects R to the robot at ADDRESS with
%   the options in this text, arms it, and runs CODE. It drives on where a loaded machine does not run
%   it for a while (fresh_ms).
%
%   Example:
%      pid = child(sim.address, '''lease_ms'', 1000', 'r.drive(0.3, 0); exit(0)')
%
%   See also watch_stop, run_code.

% SPDX-License-Identifier: MIT
code = sprintf(['sigterm_dumps_octave_core(false); ' ...
    'r = roburoc4.Robot(''%s'', ''timeout'', 60, ''fresh_ms'', 1000, %s); r.arm(60); %s'], ...
    address, options, code);
pid = system(['exec ' octave_command(code) ' >/dev/null 2>&1'], false, 'async');
end
