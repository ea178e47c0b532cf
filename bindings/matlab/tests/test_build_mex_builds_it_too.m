function test_build_mex_builds_it_too()
% The MEX file of build_mex works without CMake, as users build it. (In MATLAB it is what is tested.)
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
root = fileparts(fileparts(mfilename('fullpath')));
folder = tempname();
mkdir(folder);
copyfile(fullfile(root, '+roburoc4'), fullfile(folder, '+roburoc4'));
cleanup = onCleanup(@() remove(folder));
addpath(root, '-end');
output = evalc('build_mex(''-R2018a'', fullfile(folder, ''+roburoc4'', ''+internal''));');
check(~isempty(strfind(output, 'built ')), '%s', output);
check_raises('roburoc4:badArgument', @() build_mex('-R2020a'));
code = ['addpath(''' folder '''); sim = roburoc4.Simulator(); r = sim.connect(); r.arm(); ' ...
    'r.driveFor(0.5, 0, 1); x = sim.state.true_x_m; delete(r); delete(sim); ' ...
    'printf(''moved %d\n'', x > 0.1); exit(0)'];
program = fullfile(OCTAVE_HOME(), 'bin', 'octave-cli');
[status, text] = system(sprintf('"%s" -q --no-init-file --eval "%s" 2>&1', program, code));
check(status == 0 && ~isempty(strfind(text, 'moved 1')), 'status %d: %s', status, text);
end

function remove(folder)
confirm_recursive_rmdir(false, 'local');
rmdir(folder, 's');
end
