function text = kind(value)
%KIND Describe a value for a message: its size and its class.
%   TEXT = roburoc4.internal.kind(VALUE) is '1x3 double' for [1 2 3].
%
%   Example:
%      roburoc4.internal.kind('abc')
%
%   See also size, class.

% SPDX-License-Identifier: MIT
sizes = sprintf('%dx', size(value));
text = [sizes(1:end - 1) ' ' class(value)];
end
