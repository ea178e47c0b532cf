function shortest(limit_s, name, measure)
%SHORTEST Measure until it takes less than a limit; fail where it never does.
%   shortest(LIMIT_S, NAME, MEASURE) calls MEASURE up to ten times: a loaded machine is
%   sometimes late, a program that breaks its promise always is. NaN is no measurement.
%
%   Example:
%      shortest(0.9, 'delete', @() stop_s())
%
%   See also watch_stop.

% SPDX-License-Identifier: MIT
tries_s = [];
while ~any(tries_s < limit_s)
    check(numel(tries_s) < 10, '%s: not within %g s, but %s', name, limit_s, ...
        sprintf('%g ', tries_s));
    tries_s(end + 1) = measure(); %#ok<AGROW>
end
fprintf('       %s: %.0f ms\n', name, 1000 * tries_s(end));
end
