function seconds = utc()
%UTC The time of day: seconds since 1970-01-01, UTC.
%
%   Example:
%      roburoc4.internal.utc()
%
%   See also roburoc4.Robot, datetime.

% SPDX-License-Identifier: MIT
if exist('OCTAVE_VERSION', 'builtin')
    seconds = time();
else
    seconds = posixtime(datetime('now', 'TimeZone', 'UTC'));
end
end
