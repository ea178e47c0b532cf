function row = text(value, name)
%TEXT Convert a text of either kind to a char row, or raise an error.
%   ROW = roburoc4.internal.text(VALUE, NAME) takes 'abc' and, in MATLAB, "abc". NAME is
%   the value's name in messages.
%
%   Example:
%      roburoc4.internal.text('192.168.0.2', 'address')
%
%   See also roburoc4.internal.number.

% SPDX-License-Identifier: MIT
if isa(value, 'string') && isscalar(value)
    value = char(value);
end
if ~ischar(value) || isempty(value) || size(value, 1) ~= 1
    error('roburoc4:badArgument', '%s: this is %s; give a text, such as ''abc''', name, ...
        roburoc4.internal.kind(value));
end
row = value;
end
