function file = package_toolbox(file)
%PACKAGE_TOOLBOX Make a toolbox file that MATLAB's Add-On manager installs.
%   FILE = package_toolbox() writes roburoc4.mltbx into the current folder, with the MEX file of this
%   platform: run build_mex first. It needs MATLAB R2023a or later, where it was not run yet.
%   package_toolbox(FILE) writes to another file.
%
%   Example:
%      build_mex('-R2018a'); package_toolbox()
%
%   See also build_mex, matlab.addons.toolbox.packageToolbox.

% SPDX-License-Identifier: MIT
if exist('OCTAVE_VERSION', 'builtin')
    error('roburoc4:badArgument', ['Octave has no toolbox files. Add the folder build/matlab of ' ...
        'this checkout to the path']);
end
if nargin < 1
    file = fullfile(pwd, 'roburoc4.mltbx');
end
here = fileparts(mfilename('fullpath'));
if isempty(dir(fullfile(here, '+roburoc4', '+internal', ['roburoc4_mex.' mexext()])))
    error('roburoc4:notBuilt', 'there is no MEX file yet. Run build_mex first');
end
% Never change this number: MATLAB recognizes the toolbox by it.
options = matlab.addons.toolbox.ToolboxOptions(here, '4f0d8a52-5d0b-4b83-9f0e-6c1a0b7a4c04');
options.ToolboxName = 'roburoc4';
options.ToolboxVersion = '0.1.0';
options.Summary = 'Drive, watch and simulate a RobuROC4 mobile robot';
options.MinimumMatlabRelease = 'R2018a';
options.ToolboxMatlabPath = {here, fullfile(here, 'examples')};
options.OutputFile = file;
matlab.addons.toolbox.packageToolbox(options);
end
