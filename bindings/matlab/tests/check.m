function check(condition, varargin)
%CHECK Fail the test with a message, made as by sprintf, unless a condition holds.
%
%   Example:
%      check(x > 0.5, 'x is %g', x)

% SPDX-License-Identifier: MIT
if ~all(condition(:))
    error('roburoc4:check', varargin{:});
end
end
