function test_refusals_do_not_wait_forever()
% A peer that answers, but refuses all, does not keep the constructor waiting.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
file = tempname();
here = fileparts(mfilename('fullpath'));
program = getenv('PYTHON');
if isempty(program)
    program = 'python3';
end
command = sprintf('exec "%s" "%s" "%s"', program, fullfile(here, 'refuse.py'), file);
pid = system(command, false, 'async');
cleanup = onCleanup(@() kill(pid, 9));
begun = tic();
while ~exist(file, 'file')
    check(toc(begun) < 60, '%s did not begin to refuse', program);
    pause(0.01);
end
address = ['127.0.0.1:' fileread(file)];
delete(file);
begun = tic();
try
    r = roburoc4.Robot(address, 'timeout', 4);
    delete(r);
    check(false, 'connected to what refuses');
catch problem
    check(strcmp(problem.identifier, 'roburoc4:timeout'), '%s', problem.message);
    check(~isempty(strfind(problem.message, 'it answers, but refuses')), '%s', problem.message);
end
check(toc(begun) >= 3.9, 'gave up after %g s', toc(begun));
check(living_robots() == 0, 'a robot was left');
end
