function restored = without_display()
%WITHOUT_DISPLAY Draw to files only, and without warnings about fonts and gnuplot.
%   RESTORED = without_display() turns the warnings on again when RESTORED is cleared.
%
%   Example:
%      restored = without_display();

% SPDX-License-Identifier: MIT
state = warning('off', 'all');
restored = onCleanup(@() warning(state));
if exist('OCTAVE_VERSION', 'builtin')
    graphics_toolkit('gnuplot');
end
end
