function file = build_mex(api, folder)
%BUILD_MEX Build the MEX file of the roburoc4 package, in MATLAB or Octave.
%   build_mex() compiles the C sources of this checkout with the C compiler of mex (MATLAB) or
%   mkoctfile (Octave), and puts the MEX file into the folder toolbox, beside the table by which MATLAB
%   completes arguments. Then add that folder to the path.
%   build_mex('-R2018a') builds for MATLAB's API with interleaved complex numbers; the default
%   is '-R2017b'. No array here is complex, so that both are the same. Octave has one API only.
%   FILE = build_mex(API, FOLDER) puts the MEX file into another folder.
%
%   This has not been run in MATLAB yet: it uses only documented functions. Please report the result.
%
%   Example:
%      build_mex
%      addpath(fullfile(pwd, 'toolbox'))
%      sim = roburoc4.Simulator(); r = sim.connect()
%
%   See also write_signatures, mex, mkoctfile, roburoc4.Robot.

% SPDX-License-Identifier: MIT
here = fileparts(mfilename('fullpath'));
top = fullfile(here, '..', '..');
if nargin < 1 || isempty(api)
    api = '-R2017b';
end
if ~any(strcmp(api, {'-R2017b', '-R2018a'}))
    error('roburoc4:badArgument', 'api: ''%s'' is neither -R2017b nor -R2018a', api);
end
if nargin < 2
    folder = fullfile(here, 'toolbox');
end
octave = exist('OCTAVE_VERSION', 'builtin') ~= 0;

% Several folders have files of the same name, so each folder has its own objects.
work = tempname();
cleanup = onCleanup(@() remove(work)); %#ok<NASGU>
include = {['-I' fullfile(top, 'include')], ['-I' fullfile(top, 'src')], ...
    ['-I' fullfile(top, 'sim')], ['-I' fullfile(here, 'src')]};
sources = {fullfile(top, 'src'), fullfile(top, 'sim'), fullfile(here, 'src')};
if ispc()
    others = {'os_posix.c', 'main.c', 'server.c'};
    libraries = {'-lws2_32'};
else
    others = {'os_windows.c', 'main.c', 'server.c'};
    libraries = {'-lpthread', '-lm'};
end
objects = {};
for k = 1:numel(sources)
    objects = [objects, compile(sources{k}, others, fullfile(work, num2str(k)), include, api, ...
        octave)]; %#ok<AGROW>
end

file = fullfile(folder, ['roburoc4_mex.' mexext()]);
if octave
    make('link', file, '--mex', '-o', file, objects{:}, libraries{:});
else
    mex(api, '-outdir', folder, '-output', 'roburoc4_mex', objects{:}, libraries{:});
end
fprintf('built %s\n', file);
if nargin < 2
    path_before = addpath(folder);
    restore = onCleanup(@() path(path_before)); %#ok<NASGU>
    write_signatures(folder);
end
end

function objects = compile(source, others, folder, include, api, octave)
mkdir(folder);
files = dir(fullfile(source, '*.c'));
objects = {};
for k = 1:numel(files)
    if any(strcmp(files(k).name, others))
        continue
    end
    from = fullfile(source, files(k).name);
    [~, name] = fileparts(from);
    if octave
        objects{end + 1} = fullfile(folder, [name '.o']); %#ok<AGROW>
        % As mex does: our functions are hidden from other libraries in the program.
        make('compile', from, '-c', '-fvisibility=hidden', '-o', objects{end}, include{:}, from);
    else
        mex(api, '-c', '-outdir', folder, include{:}, from);
        made = dir(fullfile(folder, [name '.o*']));
        objects{end + 1} = fullfile(folder, made(1).name); %#ok<AGROW>
    end
end
end

function make(action, file, varargin)
% If mkoctfile is called with results it does not raise errors.
[~, status] = mkoctfile(varargin{:});
if status ~= 0
    error('roburoc4:build', 'mkoctfile could not %s %s', action, file);
end
end

function remove(folder)
if exist(folder, 'dir')
    % Or Octave asks before it removes a folder with files.
    if exist('OCTAVE_VERSION', 'builtin')
        confirm_recursive_rmdir(false, 'local');
    end
    rmdir(folder, 's');
end
end
