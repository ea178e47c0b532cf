function row = text(value, name)
%TEXT Make a char row of a text of either kind, or raise an error.
%   ROW = roburoc4.internal.text(VALUE, NAME) takes 'abc' and, in MATLAB, "abc". NAME is how a
%   message calls the value.
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
