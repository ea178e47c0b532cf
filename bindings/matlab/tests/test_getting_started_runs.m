function test_getting_started_runs()
% The first page of the toolbox runs as it is printed.
% SPDX-License-Identifier: MIT
restored = without_display(); %#ok<NASGU>
root = fileparts(fileparts(mfilename('fullpath')));
printed = evalc(fileread(fullfile(root, 'toolbox', 'doc', 'GettingStarted.m')));
close('all');
check(~isempty(regexp(printed, 'x 1.\d+ m, heading 90 degrees', 'once')), '%s', printed);
end
