function [others, own] = options(given, names)
%OPTIONS Make a scalar struct of 'Name', value pairs.
%   [OTHERS, OWN] = roburoc4.internal.options(GIVEN, NAMES) takes a cell row of pairs. Those whose
%   name is a field of the struct NAMES, which holds their defaults, go to OWN; all others go to
%   OTHERS, which the C library checks. Case does not matter.
%
%   Example:
%      [others, own] = roburoc4.internal.options({'lease_ms', 200}, struct('timeout', 10))
%
%   See also roburoc4.Robot, roburoc4.Simulator.

% SPDX-License-Identifier: MIT
others = struct();
own = names;
if mod(numel(given), 2) ~= 0
    error('roburoc4:badArgument', 'options come in pairs: ''Name'', value');
end
for k = 1:2:numel(given)
    name = lower(roburoc4.internal.text(given{k}, 'name of an option'));
    if isempty(regexp(name, '^[a-z]\w*$', 'once'))
        error('roburoc4:badArgument', 'there is no option ''%s''', name);
    end
    value = given{k + 1};
    if isfield(names, name)
        own.(name) = value;
    else
        others.(name) = value;
    end
end
end
