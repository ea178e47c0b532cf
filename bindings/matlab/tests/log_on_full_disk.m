function log_on_full_disk(folder)
%LOG_ON_FULL_DISK Log more than the disk, or the limit of a file's size, takes; check what is left.
%   log_on_full_disk(FOLDER) writes a short log to FOLDER, fails to write a long one, and prints
%   'kept all'.
%
%   Example:
%      run_code('log_on_full_disk(''/tmp/folder'')', 'ulimit -f 12;')

% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
r.sleep(0.1);
r.log(fullfile(folder, 'drive'));            % adds .mat
file = fullfile(folder, 'drive.mat');
before = fileread(file);
r.sleep(20);
check_raises('roburoc4:limit', @() r.log(file));
check(isequal(before, fileread(file)), 'the old file was touched');
check(numel(dir(folder)) == 3, 'something half-written was left');
kept = roburoc4_mex('log', r.id);
check(numel(kept.localization.x_m) == 400, '%d statuses are left', numel(kept.localization.x_m));
delete(r);
delete(sim);
disp('kept all');
end
