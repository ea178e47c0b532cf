function command = octave_command(code)
%OCTAVE_COMMAND The shell's command that runs code in another Octave, with the package on its path.
%   CODE may have no double quotes.
%
%   Example:
%      system(octave_command('disp(1)'))
%
%   See also run_code, child.

% SPDX-License-Identifier: MIT
toolbox = fileparts(fileparts(which('roburoc4.Simulator')));
if isempty(toolbox)
    toolbox = getenv('ROBUROC4_TOOLBOX');
end
program = fullfile(OCTAVE_HOME(), 'bin', 'octave-cli');
command = sprintf('"%s" -q --no-init-file --no-history --eval "addpath(''%s'', ''%s''); %s"', ...
    program, toolbox, fileparts(mfilename('fullpath')), code);
end
