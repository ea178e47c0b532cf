function moments = datetime(seconds, varargin)
%DATETIME A stand-in for MATLAB's, for tests in Octave.
%
%   Example:
%      datetime(0, 'ConvertFrom', 'posixtime', 'TimeZone', 'UTC')

% SPDX-License-Identifier: MIT
check(isequal(varargin, {'ConvertFrom', 'posixtime', 'TimeZone', 'UTC'}), 'arguments');
moments = seconds;
end
