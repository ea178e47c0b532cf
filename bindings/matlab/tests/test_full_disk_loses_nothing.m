function test_full_disk_loses_nothing()
% A log that does not fit on the disk is an error; the file that was there stays, and so do the
% statuses. The limit of a file's size stands for the full disk, in a program of its own.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() remove(folder));
[status, text] = run_code(sprintf('log_on_full_disk(''%s'')', folder), 'ulimit -f 12;');
check(status == 0 && ~isempty(strfind(text, 'kept all')), 'status %d: %s', status, text);
end

function remove(folder)
confirm_recursive_rmdir(false, 'local');
rmdir(folder, 's');
end
