function test_getting_started_runs()
% The first page of the toolbox runs as it is printed.
% SPDX-License-Identifier: MIT
restored = without_display(); %#ok<NASGU>
root = fileparts(fileparts(mfilename('fullpath')));
printed = evalc(fileread(fullfile(root, 'toolbox', 'doc', 'GettingStarted.m')));
close('all');
check(~isempty(regexp(printed, 'x (0.9[89]|1.0[012]) m, heading (89|90|91) degrees', 'once')), '%s', printed);
end
