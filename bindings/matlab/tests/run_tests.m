function run_tests(varargin)
%RUN_TESTS Run the tests of the roburoc4 package in MATLAB or Octave.
%   run_tests() runs each test_*.m of this folder and prints the results. If one failed it raises an
%   error, with which octave-cli and matlab -batch end with status 1. The package must be on the path.
%   run_tests(NAME, ...) runs only these.
%
%   Example:
%      run_tests('test_bad_arguments')
%
%   See also check.

% SPDX-License-Identifier: MIT
here = fileparts(mfilename('fullpath'));
addpath(here, fullfile(here, '..', 'toolbox', 'examples'));
names = varargin;
if isempty(names)
    files = dir(fullfile(here, 'test_*.m'));
    names = strrep({files.name}, '.m', '');
end
failed = 0;
for k = 1:numel(names)
    begun = tic();
    try
        feval(names{k});
        check_nothing_lives();
        fprintf('ok     %-40s %6.2f s\n', names{k}, toc(begun));
    catch problem
        failed = failed + 1;
        fprintf('FAILED %-40s %6.2f s\n       %s: %s\n', names{k}, toc(begun), ...
            problem.identifier, problem.message);
        for step = 1:numel(problem.stack)
            fprintf('       in %s, line %d\n', problem.stack(step).name, problem.stack(step).line);
        end
    end
end
fprintf('%d of %d tests passed\n', numel(names) - failed, numel(names));
if failed > 0
    error('roburoc4:testsFailed', '%d tests failed', failed);
end
end

function check_nothing_lives()
living = roburoc4_mex('living');
check(living.robots == 0 && living.simulators == 0, ...
    '%d robots and %d simulators are left after the test', living.robots, living.simulators);
end
