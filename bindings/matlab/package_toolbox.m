function file = package_toolbox(file)
%PACKAGE_TOOLBOX Make a toolbox file that MATLAB's Add-On manager installs.
%   FILE = package_toolbox() writes roburoc4.mltbx into the current folder, with the folder toolbox and
%   nothing else. Run build_mex first: the file claims the platforms whose MEX files are there, and
%   this release and later ones, as a MEX file may not run in older ones. It needs MATLAB R2023a or
%   later, and has not been run there yet. package_toolbox(FILE) writes to another file.
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
folder = fullfile(fileparts(mfilename('fullpath')), 'toolbox');
if isempty(dir(fullfile(folder, ['roburoc4_mex.' mexext()])))
    error('roburoc4:notBuilt', 'there is no MEX file yet. Run build_mex first');
end
% Never change this number: MATLAB recognizes the toolbox by it.
options = matlab.addons.toolbox.ToolboxOptions(folder, '4f0d8a52-5d0b-4b83-9f0e-6c1a0b7a4c04');
options.ToolboxName = 'roburoc4';
options.ToolboxVersion = header_version();
options.Summary = 'Drive, watch and simulate a RobuROC4 mobile robot';
options.MinimumMatlabRelease = ['R' version('-release')];
options.MaximumMatlabRelease = '';
if ~verLessThan('matlab', '25.1') % before R2025a, a live script cannot be plain text
    options.ToolboxGettingStartedGuide = fullfile(folder, 'doc', 'GettingStarted.m');
end
names = fieldnames(options.SupportedPlatforms);
for k = 1:numel(names)
    options.SupportedPlatforms.(names{k}) = is_built(folder, names{k});
end
options.ToolboxMatlabPath = {folder, fullfile(folder, 'examples'), fullfile(folder, 'simulink')};
options.OutputFile = file;
matlab.addons.toolbox.packageToolbox(options);
end

function version = header_version()
header = fileread(fullfile(fileparts(mfilename('fullpath')), '..', '..', 'include', 'roburoc4.h'));
parts = regexp(header, '#define ROBUROC4_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)', 'tokens');
version = strjoin([parts{:}], '.');
end

function built = is_built(folder, platform)
% MATLAB Online has no MEX file of its own. A Mac has one of two, by its processor.
extensions = {'Glnxa64', 'mexa64'; 'Win64', 'mexw64'; 'Maci64', 'mexmaci64'; 'Maci64', 'mexmaca64'};
mine = extensions(strcmp(extensions(:, 1), platform), 2);
built = any(cellfun(@(extension) ~isempty(dir(fullfile(folder, ['roburoc4_mex.' extension]))), mine));
end
