function test_any_file_name_takes_a_log()
% A file name is neither expanded as a pattern nor passed to a shell.
% SPDX-License-Identifier: MIT
folder = tempname();
mkdir(folder);
before = cd(folder);
cleanup = onCleanup(@() leave(before, folder));
sim = roburoc4.Simulator();
r = sim.connect();
names = {'run[1].mat', 'a b.mat', 'it''s.mat', 'a&b;c.mat'};
if ~ispc()
    names = [names, {'a$(echo x >made).mat', 'a`echo x >made`.mat', 'star*.mat', 'a"b.mat'}];
end
for k = 1:numel(names)
    for again = 1:2
        r.sleep(0.2);
        r.log(names{k});
    end
    data = load(fullfile(folder, names{k}));
    check(numel(data.localization.x_m) == 4, '%s: %d', names{k}, numel(data.localization.x_m));
end
found = dir(folder);
found = setdiff({found.name}, {'.', '..'});
check(isequal(found, sort(names)), 'there are also: %s', strjoin(setdiff(found, names), ', '));
delete(r);
delete(sim);
end

function leave(before, folder)
cd(before);
if exist('OCTAVE_VERSION', 'builtin')
    confirm_recursive_rmdir(false, 'local');
end
rmdir(folder, 's');
end
