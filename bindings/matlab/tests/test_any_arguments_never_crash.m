function test_any_arguments_never_crash()
% Thousands of calls of the MEX file, past the .m files, with arguments of all kinds in any number:
% each succeeds or raises one of this package's errors.
% SPDX-License-Identifier: MIT
names = commands();
check(numel(names) > 30, 'only %d commands', numel(names));
seed = 1;
for round = 1:15
    sim = roburoc4.Simulator();
    r = sim.connect();
    values = arguments_for(r, sim);
    opened = [];
    for k = 1:60
        [seed, place] = drawn(seed, numel(names));
        [seed, count] = drawn(seed, 5);
        given = cell(1, count - 1);
        for n = 1:count - 1
            % Mostly with an id first, or the other arguments would not be looked at.
            among = numel(values);
            if n == 1 && mod(k, 5) > 0
                among = 12;
            end
            [seed, which_one] = drawn(seed, among);
            given{n} = values{which_one};
        end
        opened = [opened, called(names{place}, given)]; %#ok<AGROW>
    end
    for k = 1:numel(opened)
        roburoc4_mex('close', opened(k));
        roburoc4_mex('simClose', opened(k));
    end
    delete(r);
    delete(sim);
end
end

function id = called(name, given)
% Call it; return the ids of what it opened.
id = [];
try
    if any(strcmp(name, {'simOpen', 'simConnect'}))
        id = roburoc4_mex(name, given{:});
    else
        roburoc4_mex(name, given{:});
    end
catch problem
    check(strncmp(problem.identifier, 'roburoc4:', 9), '%s raised %s: %s', name, ...
        problem.identifier, problem.message);
end
end

function [seed, number] = drawn(seed, most)
% A number from 1 to most, from the same sequence in each run.
seed = mod(16807 * seed, 2 ^ 31 - 1);
number = 1 + floor(seed / 2 ^ 31 * most);
end

function values = arguments_for(r, sim)
values = {r.id, r.id, r.id, r.id, r.id, r.id, r.id, r.id, sim.id, sim.id, sim.id, sim.id, ...
    0, 1, 3, -1, 0.05, NaN, Inf, 1e300, [], [1 2], zeros(0, 3), 1i, sparse(1), single(NaN), ...
    uint8(3), int64(-1), true, [true false], {}, {1}, '', 'x', 'iocard', 'Front bumper', ...
    'pad a down', 'status', ['a'; 'b'], repmat('x', 1, 511), repmat('x', 1, 5000), ...
    char(200:255), struct(), struct('a', {1, 2}), struct('lease_ms', []), ...
    struct('lease_ms', {{}}), struct('seed', -1), struct('buffer', 16), @sin};
end

function names = commands()
% The names in the tables of the C files, without 'open', which would ask name servers.
folder = fullfile(fileparts(fileparts(mfilename('fullpath'))), 'src');
files = dir(fullfile(folder, '*.c'));
names = {'living'};
for k = 1:numel(files)
    text = fileread(fullfile(folder, files(k).name));
    found = regexp(text, '\{"(\w+)", [A-Z_]+, [A-Z]+, \w+,', 'tokens');
    names = [names, cellfun(@(one) one{1}, found, 'UniformOutput', false)]; %#ok<AGROW>
end
names = setdiff(names, {'open'});
end
