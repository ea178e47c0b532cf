function test_build_mex_builds_it_too()
% The MEX file of build_mex works without CMake, as users build it. (In MATLAB it is what is tested.)
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
root = fileparts(fileparts(mfilename('fullpath')));
folder = tempname();
mkdir(folder);
copyfile(fullfile(root, 'toolbox', '+roburoc4'), fullfile(folder, '+roburoc4'));
cleanup = onCleanup(@() remove(folder));
addpath(root, '-end');
output = evalc('build_mex(''-R2018a'', folder);');
file = fullfile(folder, 'roburoc4_mex.mex');
check(exist(file, 'file') && ~isempty(strfind(output, ['built ' file])), '%s', output);
here = fullfile(root, 'tests');
[status, text] = system(sprintf('sh "%s" "%s" "%s" 2>&1', fullfile(here, 'mex_symbols.sh'), file, ...
    fullfile(here, 'mex_symbols.txt')));
check(status == 0, '%s', text);
check_raises('roburoc4:badArgument', @() build_mex('-R2020a'));
code = ['addpath(''' folder '''); sim = roburoc4.Simulator(); r = sim.connect(); r.arm(); ' ...
    'r.driveFor(0.5, 0, 1); x = sim.state.true_x_m; delete(r); delete(sim); ' ...
    'printf(''moved %d\n'', x > 0.1); exit(0)'];
program = fullfile(OCTAVE_HOME(), 'bin', 'octave-cli');
[status, text] = system(sprintf('"%s" -q --no-init-file --eval "%s" 2>&1', program, code));
check(status == 0 && ~isempty(strfind(text, 'moved 1')), 'status %d: %s', status, text);

% A failure to compile or link is an error, or the old file would still be used.
refused(root, folder, 'CC=false', 'could not compile');
refused(root, folder, 'CFLAGS=-fPIC LDFLAGS=-l:no_such_library', 'could not link');
end

function refused(root, folder, before, why)
[status, text] = run_code(sprintf('addpath(''%s'', ''-end''); build_mex([], ''%s'')', root, ...
    folder), before);
check(status ~= 0 && ~isempty(strfind(text, why)), '%s: status %d: %s', before, status, text);
check(isempty(strfind(text, 'built ')), '%s: %s', before, text);
end

function remove(folder)
confirm_recursive_rmdir(false, 'local');
rmdir(folder, 's');
end
