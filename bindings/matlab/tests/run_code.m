function [status, text] = run_code(code, before)
%RUN_CODE Run code in another Octave, which has the package and this folder on its path.
%   [STATUS, TEXT] = run_code(CODE) returns its exit status and what it printed.
%   run_code(CODE, BEFORE) runs a command of the shell before, as 'ulimit -f 12;'. Neither may have
%   double quotes.
%
%   Example:
%      [status, text] = run_code('disp(1)')
%
%   See also child.

% SPDX-License-Identifier: MIT
if nargin < 2
    before = '';
end
[status, text] = system(sprintf('%s %s 2>&1', before, octave_command(code)));
end
