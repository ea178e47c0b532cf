function pid = child(address, code)
%CHILD Start another Octave that drives a robot.
%   PID = child(ADDRESS, CODE) starts a program that connects R to the robot at ADDRESS, arms it, and
%   runs CODE.
%
%   Example:
%      pid = child(sim.address, 'r.drive(0.3, 0); exit(0)')

% SPDX-License-Identifier: MIT
toolbox = fileparts(fileparts(which('roburoc4.Simulator')));
if isempty(toolbox)
    toolbox = getenv('ROBUROC4_TOOLBOX');
end
program = fullfile(OCTAVE_HOME(), 'bin', 'octave-cli');
script = sprintf('sigterm_dumps_octave_core(false); addpath(''%s''); r = roburoc4.Robot(''%s''); r.arm(10); %s', toolbox, address, ...
    code);
pid = system(sprintf('exec "%s" -q --no-init-file --eval "%s" >/dev/null 2>&1', program, script), ...
    false, 'async');
end
