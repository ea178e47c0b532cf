function write(file, data)
%WRITE Write the fields of a scalar struct to a MAT-file, completely or not at all.
%   roburoc4.internal.write(FILE, DATA) writes to FILE.part, reads that back, and only then renames
%   it: Octave's save does not notice a full disk. On an error an existing FILE stays as it was.
%   '.mat' is added if FILE has no extension.
%
%   Example:
%      roburoc4.internal.write('drive.mat', data)
%
%   See also save, roburoc4.Robot.

% SPDX-License-Identifier: MIT
[~, ~, extension] = fileparts(file);
if isempty(extension)
    file = [file '.mat'];
end
part = [file '.part'];
handle = -1;
if ~exist(file, 'dir')
    handle = fopen(part, 'w');
end
if handle < 0
    error('roburoc4:badArgument', 'cannot write to ''%s''; give another file', file);
end
fclose(handle);
cleanup = onCleanup(@() remove(part)); %#ok<NASGU>
try
    save(part, '-struct', 'data', '-v7');
    whole = isequaln(load(part, '-mat'), data);
catch
    whole = false;
end
if ~whole
    error('roburoc4:limit', ['''%s'' could not be written completely. Is the disk full? Nothing is ' ...
        'lost: call log again with another file'], file);
end
[moved, why] = move(part, file);
if ~moved
    error('roburoc4:badArgument', 'cannot write to ''%s'' (%s); give another file', file, why);
end
end

% Octave's movefile and delete take the name as a pattern, and movefile passes it to a shell.
function [moved, why] = move(part, file)
if exist('OCTAVE_VERSION', 'builtin')
    [failed, why] = rename(part, file);
    if failed && ispc()
        % There rename does not replace an existing file.
        [~, ~] = unlink(file);
        [failed, why] = rename(part, file);
    end
    moved = failed == 0;
else
    [moved, why] = movefile(part, file, 'f');
end
end

function remove(part)
if exist('OCTAVE_VERSION', 'builtin')
    [~, ~] = unlink(part);
elseif exist(part, 'file')
    delete(part);
end
end
