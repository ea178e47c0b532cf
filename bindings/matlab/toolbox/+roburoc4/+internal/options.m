function [others, own] = options(given, own, simulated)
%OPTIONS Make a scalar struct of 'Name', value pairs.
%   [OTHERS, OWN] = roburoc4.internal.options(GIVEN, OWN) takes a cell row of pairs. Their names must
%   be fields of the struct OWN, which holds their defaults. Case does not matter.
%   options(GIVEN, OWN, SIMULATED) also takes the options of a robot (false) or simulator (true) of
%   the C library, and puts these into the struct OTHERS; the library checks their values.
%
%   Example:
%      [others, own] = roburoc4.internal.options({'lease_ms', 200}, struct('timeout', 10), false)
%
%   See also roburoc4.Robot, roburoc4.Simulator.

% SPDX-License-Identifier: MIT
others = struct();
known = fieldnames(own);
if nargin > 2
    known = [fieldnames(roburoc4_mex('options', simulated)); known];
end
if mod(numel(given), 2) ~= 0
    error('roburoc4:badArgument', 'options come in pairs: ''Name'', value');
end
for k = 1:2:numel(given)
    name = lower(roburoc4.internal.text(given{k}, 'name of an option'));
    value = given{k + 1};
    if isfield(own, name)
        own.(name) = value;
    elseif any(strcmp(name, known))
        others.(name) = value;
    else
        [fewest, nearest] = min(cellfun(@(option) changes(name, option), known));
        meant = '.';
        if fewest < 3
            meant = sprintf('; did you mean ''%s''?', known{nearest});
        end
        error('roburoc4:badArgument', 'there is no option ''%s''%s There are %s', name, meant, ...
            strjoin(known', ', '));
    end
end
end

function count = changes(a, b)
% How many letters to change, insert or delete between two names (Levenshtein).
row = 0:numel(b);
for k = 1:numel(a)
    row = [k, min(row(2:end) + 1, row(1:end - 1) + (a(k) ~= b))];
    for n = 2:numel(row)
        row(n) = min(row(n), row(n - 1) + 1);
    end
end
count = row(end);
end
