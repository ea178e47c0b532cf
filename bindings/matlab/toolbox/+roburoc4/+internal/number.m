function checked = number(value, name, least, most)
%NUMBER Check that a value is one finite real number within a range.
%   CHECKED = roburoc4.internal.number(VALUE, NAME, LEAST, MOST) returns it as a double.
%   NAME is the value's name in messages.
%
%   Example:
%      roburoc4.internal.number(2.5, 'seconds', 0, Inf)
%
%   See also roburoc4.internal.text.

% SPDX-License-Identifier: MIT
if isnumeric(value) && ~isreal(value)
    error('roburoc4:badArgument', '%s: this is a complex number; give one real number', name);
end
if ~(isnumeric(value) || islogical(value)) || ~isscalar(value)
    error('roburoc4:badArgument', '%s: this is %s; give one real number', name, ...
        roburoc4.internal.kind(value));
end
checked = double(value);
if isnan(checked)
    error('roburoc4:badArgument', '%s: this is NaN; give a number', name);
end
if ~isfinite(checked) || checked < least || checked > most
    error('roburoc4:badArgument', '%s: %g is out of range; give %g to %g', name, checked, least, most);
end
end
